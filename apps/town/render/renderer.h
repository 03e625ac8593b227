#pragma once

#include <opencv2/core.hpp>

#include "apps/town/image/stitch.h"
#include "apps/town/render/ray_scene.h"
#include "apps/town/render/shading.h"
#include "slam/geometry/camera.h"
#include "slam/geometry/rigid3.h"

namespace orb360::town {

/// The panorama from a pose, 8-bit BGR, with four samples a pixel and a ray to a point of the
/// sun's disc for each. The same bytes for any number of threads (OpenMP's current maximum).
cv::Mat3b RenderColour(const FrameScene& scene, const Shader& shader,
                       const EquirectangularCamera& camera, const Rigid3& world_from_camera);

/// The same before the tone curve: linear radiance, blue, green, red.
cv::Mat3f RenderRadiance(const FrameScene& scene, const Shader& shader,
                         const EquirectangularCamera& camera, const Rigid3& world_from_camera);

/// What the rays through the pixels' centres meet.
struct GeometryImage {
  cv::Mat1f range;   ///< metres along the ray, 0 where it meets nothing
  cv::Mat1w object;  ///< FrameScene::ObjectId
};
GeometryImage RenderGeometry(const FrameScene& scene, const EquirectangularCamera& camera,
                             const Rigid3& world_from_camera);

/// As above by the six faces of a cube, `size` pixels wide and high.
CubeImages<cv::Vec3b> RenderCubeColour(const FrameScene& scene, const Shader& shader, int size,
                                       const Rigid3& world_from_camera);
CubeImages<cv::Vec3f> RenderCubeRadiance(const FrameScene& scene, const Shader& shader, int size,
                                         const Rigid3& world_from_camera);
/// Metres along each face's optical axis, 0 where nothing is met.
CubeImages<float> RenderCubeDepth(const FrameScene& scene, int size,
                                  const Rigid3& world_from_camera);

}  // namespace orb360::town
