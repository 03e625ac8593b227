#include "slam/pipeline/global_adjustment.h"

#include <utility>

#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/loop_correction.h"

namespace orb360 {

AdjustedMap AdjustMap(GlobalAdjustment job, const Options& options) {
  AdjustedMap result{.before = job.map, .after = std::move(job.map)};
  AdjustGlobally(options.loop.bundle_iterations, job.ground, options.loop.height_sigma,
                 &result.after, options.mapper.bundle.optimizer);
  return result;
}

MapUpdate TakeOver(const AdjustedMap& adjusted, KeyframeId reference, Map* map) {
  MapUpdate update{.reference = map->LivingKeyframe(reference)};
  update.corrections = AdoptAdjustment(adjusted.before, adjusted.after, map);
  update.correction = update.corrections[update.reference];
  return update;
}

}  // namespace orb360
