#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/pipeline/atlas.h"
#include "slam/pipeline/loop_detector.h"
#include <orb360/slam/map/map.h>
#include <orb360/slam/optimization/optimizer.h>

namespace orb360 {

/// Closes a loop of the map. A pose graph of all keyframes, with edges for covisibility and for the
/// revisits of the loop, brings the ends together. Landmarks move with their keyframes, and those
/// that both ends see are fused. Returns, by keyframe id, the similarity that moved the world
/// around each keyframe (for a removed keyframe, that of the keyframe that replaces it). Where the
/// solver fails numerically, the result is empty and the map is unchanged.
std::vector<Similarity3> CloseLoop(const Loop& loop, Map* map,
                                   Optimizer optimizer = Optimizer::kSchur);

/// Merges the present map into the finished map of a loop, in the world frame and the scale of the
/// latter. The ids of the finished map stay; those of the present one grow by keyframe_end() and
/// landmark_end() of the finished one. `correction` receives the similarity that moved the world of
/// the present map.
Map MergeMaps(const Loop& loop, Map present, Map finished, Similarity3* correction);

/// Applies a bundle adjustment of a copy of the map (`before` and `adjusted`) to the map itself,
/// which has changed in the meantime. Keyframes and landmarks that are newer than the copy move
/// with their surroundings. Returns the similarity that moved the world around each keyframe, as
/// above.
std::vector<Similarity3> AdoptAdjustment(const Map& before, const Map& adjusted, Map* map);

/// A job that corrects a loop beside tracking: within the present map, or by a merge with the
/// finished map to which the place belongs.
struct LoopCorrection {
  ActiveMap active;
  std::span<const Map> finished;
  Loop loop;
  KeyframeId reference;  ///< The keyframe around which tracking goes on.
};

/// The result of LoopCorrection. Where the correction fails numerically, `closed` is empty and the
/// map is unchanged.
struct CorrectedLoop {
  ActiveMap active;
  MapUpdate update = {};
  std::optional<ClosedLoop> closed = {};
};

CorrectedLoop CorrectLoop(LoopCorrection job, Optimizer optimizer);

}  // namespace orb360
