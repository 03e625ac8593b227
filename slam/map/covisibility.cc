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

}  // namespace orb360
