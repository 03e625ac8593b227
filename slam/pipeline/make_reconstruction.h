#pragma once

#include <span>

#include "slam/map/map.h"
#include "slam/pipeline/frame_anchor.h"
#include "slam/pipeline/reconstruction.h"

namespace orb360 {

/// Landmarks in common that link two keyframes in the covisibility graph.
inline constexpr int kCovisible = 15;

/// Everything but `initialized_at`, `depth_scales`, what is counted and which maps are metric.
/// Keyframes have the pose that the map gives them, and the other frames the one in which they see
/// its landmarks best (frame_refinement.h). Runs on `num_threads` OpenMP threads.
Reconstruction MakeReconstruction(std::span<const Map> maps, const FrameAnchors& anchors,
                                  int num_threads = 1);

}  // namespace orb360
