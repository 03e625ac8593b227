#include "slam/pipeline/map_update.h"

namespace orb360 {

MapUpdate RescaleMap(double factor, KeyframeId reference, Map* map) {
  const Eigen::Vector3d center = map->PoseOf(0).translation;
  const Similarity3 gauge{factor, Eigen::Quaterniond::Identity(), (1 - factor) * center};
  map->Transform(gauge);
  return {.reference = map->LivingKeyframe(reference),
          .correction = gauge,
          .corrections = std::vector<Similarity3>(map->keyframe_end(), gauge)};
}

}  // namespace orb360
