#pragma once

#include <vector>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// Two keyframes that observe common landmarks.
struct CovisibilityEdge {
  KeyframeId first;  ///< The smaller id.
  KeyframeId second;
  int shared;  ///< Landmarks seen by both.
};

/// Returns all pairs of keyframes with at least `min_shared` landmarks in common, ordered by their
/// ids.
std::vector<CovisibilityEdge> FindCovisibilityEdges(const Map& map, int min_shared);

/// Marks, by id, the keyframes that share at least `min_shared` landmarks with `keyframe`, those
/// that share as many with one of them, and `keyframe` itself.
std::vector<uint8_t> MarkCovisible(const Map& map, KeyframeId keyframe, int min_shared);

}  // namespace orb360
