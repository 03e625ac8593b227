#include "slam/map/covisibility.h"

#include <algorithm>
#include <utility>

namespace orb360 {

std::vector<CovisibilityEdge> FindCovisibilityEdges(const Map& map, int min_shared) {
  std::vector<CovisibilityEdge> edges;
  for (const KeyframeId id : map.KeyframeIds()) {
    for (const Map::Covisible& other :
         map.FindCovisible(map.keyframe(id).landmarks, min_shared, id)) {
      if (other.keyframe > id) edges.push_back({id, other.keyframe, other.shared});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const CovisibilityEdge& a, const CovisibilityEdge& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  return edges;
}

std::vector<uint8_t> MarkCovisible(const Map& map, KeyframeId keyframe, int min_shared) {
  std::vector<uint8_t> is_covisible(map.keyframe_end(), 0);
  is_covisible[keyframe] = 1;
  for (const Map::Covisible& near :
       map.FindCovisible(map.keyframe(keyframe).landmarks, min_shared, keyframe)) {
    is_covisible[near.keyframe] = 1;
    for (const Map::Covisible& next :
         map.FindCovisible(map.keyframe(near.keyframe).landmarks, min_shared)) {
      is_covisible[next.keyframe] = 1;
    }
  }
  return is_covisible;
}

}  // namespace orb360
