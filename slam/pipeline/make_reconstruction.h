#pragma once

#include <span>

#include "slam/pipeline/frame_anchor.h"
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// Number of landmarks in common that links two keyframes in the covisibility graph.
inline constexpr int kCovisible = 15;

/// Makes the reconstruction except for `initialized_at`, the counts of events, and
/// the scale of the maps. Keyframes have their poses in the map; the poses of the other frames are
/// refined on the landmarks that they see (frame_refinement.h). Runs on `num_threads` OpenMP
/// threads.
Reconstruction MakeReconstruction(std::span<const Map> maps, const FrameAnchors& anchors,
                                  int num_threads = 1);

}  // namespace orb360
