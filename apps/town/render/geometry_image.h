#pragma once

#include <opencv2/core.hpp>

#include "apps/town/image/stitch.h"
#include "apps/town/render/ray_scene.h"
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360::town {

/// The surfaces that the rays through the pixels' centres meet.
struct GeometryImage {
  cv::Mat1f range;   ///< metres along the ray, 0 where it meets nothing
  cv::Mat1w object;  ///< FrameScene::ObjectId
};
GeometryImage RenderGeometry(const FrameScene& scene, const EquirectangularCamera& camera,
                             const Rigid3& world_from_camera);

/// The same for the six faces of a cube, `size` pixels wide and high: metres along each face's
/// optical axis, 0 where nothing is hit.
CubeImages<float> RenderCubeDepth(const FrameScene& scene, int size,
                                  const Rigid3& world_from_camera);

}  // namespace orb360::town
