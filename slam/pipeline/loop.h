#pragma once

#include <optional>
#include <span>
#include <vector>

#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/loop_options.h>

namespace orb360 {

/// A keyframe that sees a place again.
struct Revisit {
  KeyframeId keyframe;
  KeyframeId place;  ///< A keyframe of the map to which the place belongs.
  /// Transforms points from the camera frame of `keyframe` into that of `place`. Its scale is the
  /// ratio of the units of length around the two.
  Similarity3 place_from_keyframe;
  int shared;  ///< Number of the place's landmarks that were found.
};

/// A loop: the camera has come back to a place.
struct Loop {
  /// The finished map to which the place belongs. None where it belongs to the present map.
  std::optional<int> finished_map;
  std::vector<Revisit> revisits;  ///< Ordered by keyframe.
};

/// Adapts a loop of the present map to a change of the map's unit of length. `corrections`
/// contains, by keyframe id, the similarity that moved the world around each keyframe.
void Rescale(std::span<const Similarity3> corrections, Loop* loop);

/// Returns the similarity that moves the world around the revisiting keyframe to the place.
Similarity3 CorrectionBy(const Revisit& revisit, const Map& map, const Map& place_map);

/// Whether a map can have drifted as a correction of its newest part says, which begins at `here`,
/// after a way of that length, world units.
bool IsPlausible(const Similarity3& correction, const Eigen::Vector3d& here, double way,
                 const LoopOptions& options);

}  // namespace orb360
