#include "apps/town/render/stage.h"

#include "apps/town/render/irradiance.h"
#include "apps/town/render/openness.h"

namespace orb360::town {

Stage::Stage(Scenery* scenery, const Light& light, uint64_t seed)
    : light_(light), sky_(light_, seed), scene_(*scenery), shader_(scenery->palette, light_, sky_) {
  if (!scenery->lamps.empty()) BakeIrradiance(scene_, light_, scenery);
  BakeOpenness(scene_, scenery);
}

}  // namespace orb360::town
