#include "slam/pipeline/loop.h"

#include <cmath>

#include <orb360/slam/geometry/so3.h>

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

bool IsPlausible(const Similarity3& correction, const Eigen::Vector3d& here, double way,
                 const LoopOptions& options) {
  const double scale_drift = std::abs(std::log(correction.scale));
  // A scale that has drifted steadily by exp(d) displaces the end of a closed path by about half of
  // d times its length.
  const double max_displacement = (options.max_drift + 0.5 * scale_drift) * way;
  return scale_drift <= std::log(options.max_scale) &&
         LogSo3(correction.rotation).norm() <= options.max_turn &&
         (correction * here - here).norm() <= max_displacement;
}

}  // namespace orb360
