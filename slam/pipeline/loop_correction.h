#pragma once

#include <vector>

#include "slam/map/map.h"
#include "slam/optimization/optimizer.h"
#include "slam/pipeline/loop_detector.h"

namespace orb360 {

/// Closes a loop of the map: a pose graph of all keyframes (covisibility, and the loop's revisits)
/// brings the ends together, landmarks go along with their keyframes, and those that both ends have
/// are fused. Returns by keyframe id what moved the world around each (removed keyframes: around
/// the one that stands for them); nothing, and the map as it was, where that fails numerically.
std::vector<Similarity3> CloseLoop(const Loop& loop, Map* map,
                                   Optimizer optimizer = Optimizer::kSchur);

/// Joins the present map to the finished one that a loop leads to, in the latter's world and scale.
/// Ids of the finished map stay; those of the present one grow by keyframe_end() and landmark_end()
/// of the finished one. `correction` receives what moved the present map's world.
Map JoinMaps(const Loop& loop, Map present, Map finished, Similarity3* correction);

/// What a bundle adjustment of a copy of the map (`before` it, and `adjusted`) means for the map
/// itself, which has changed in the meantime: everything moves with it, what is newer as well.
/// Returns what moved the world around each keyframe, as above.
std::vector<Similarity3> AdoptAdjustment(const Map& before, const Map& adjusted, Map* map);

}  // namespace orb360
