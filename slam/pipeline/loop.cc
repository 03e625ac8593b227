#include "slam/pipeline/loop.h"

namespace orb360 {

void Rescale(std::span<const Similarity3> corrections, Loop* loop) {
  for (Revisit& revisit : loop->revisits) {
    const double of_place = loop->finished_map ? 1.0 : corrections[revisit.place].scale;
    revisit.place_from_keyframe.scale *= of_place / corrections[revisit.keyframe].scale;
    revisit.place_from_keyframe.translation *= of_place;
  }
}

Similarity3 CorrectionBy(const Revisit& revisit, const Map& map, const Map& place_map) {
  return ToSimilarity(place_map.PoseOf(revisit.place)) * revisit.place_from_keyframe *
         ToSimilarity(map.PoseOf(revisit.keyframe).Inverse());
}

}  // namespace orb360
