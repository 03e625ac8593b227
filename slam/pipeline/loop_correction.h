#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/map/map.h"
#include "slam/optimization/optimizer.h"
#include "slam/pipeline/atlas.h"
#include "slam/pipeline/loop_detector.h"

namespace orb360 {

/// Closes a loop of the map: a pose graph of all keyframes (covisibility, and the loop's revisits)
/// brings the ends together, landmarks go along with their keyframes, and those that both ends have
/// are fused. Returns by keyframe id what moved the world around each (removed keyframes: around
/// the one that stands for them); nothing, and the map as it was, where that fails numerically.
std::vector<Similarity3> CloseLoop(const Loop& loop, Map* map,
                                   Optimizer optimizer = Optimizer::kSchur);

/// Merges the present map into the finished one that a loop leads to, in the latter's world and
/// scale. Ids of the finished map stay; those of the present one grow by keyframe_end() and
/// landmark_end() of the finished one. `correction` receives what moved the present map's world.
Map MergeMaps(const Loop& loop, Map present, Map finished, Similarity3* correction);

/// What a bundle adjustment of a copy of the map (`before` it, and `adjusted`) means for the map
/// itself, which has changed in the meantime: everything moves with it, what is newer as well.
/// Returns what moved the world around each keyframe, as above.
std::vector<Similarity3> AdoptAdjustment(const Map& before, const Map& adjusted, Map* map);

/// The correction of a loop, beside tracking: within the present map, or by a merge with the
/// finished map that the place is in.
struct LoopCorrection {
  ActiveMap active;
  std::span<const Map> finished;
  Loop loop;
  KeyframeId reference;  // around which tracking goes on
};

/// What came of it. `closed` is empty, and the map as it was, where the correction fails
/// numerically.
struct CorrectedLoop {
  ActiveMap active;
  MapUpdate update = {};
  std::optional<ClosedLoop> closed = {};
};

CorrectedLoop CorrectLoop(LoopCorrection job, Optimizer optimizer);

}  // namespace orb360
