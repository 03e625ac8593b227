#pragma once

#include <opencv2/core.hpp>

#include "apps/town/image/stitch.h"
#include "apps/town/render/ray_scene.h"
#include "apps/town/render/shading.h"
#include "apps/town/render/tile_renderer.h"
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360::town {

/// Renders the panorama from a pose, 8-bit BGR. The bytes are the same for any number of threads
/// (OpenMP's current maximum).
cv::Mat3b RenderColour(const FrameScene& scene, const Shader& shader,
                       const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                       Sampling sampling = Sampling::kAdaptive);

/// Renders the same before the tone curve: linear radiance, blue, green, red.
cv::Mat3f RenderRadiance(const FrameScene& scene, const Shader& shader,
                         const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                         Sampling sampling = Sampling::kAdaptive);

/// Renders the same for the six faces of a cube, `size` pixels wide and high.
CubeImages<cv::Vec3b> RenderCubeColour(const FrameScene& scene, const Shader& shader, int size,
                                       const Rigid3& world_from_camera,
                                       Sampling sampling = Sampling::kAdaptive);
CubeImages<cv::Vec3f> RenderCubeRadiance(const FrameScene& scene, const Shader& shader, int size,
                                         const Rigid3& world_from_camera,
                                         Sampling sampling = Sampling::kAdaptive);

}  // namespace orb360::town
