#pragma once

#include "apps/town/render/ray_scene.h"
#include "apps/town/render/sky.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// Computes Mesh::irradiance of the fixed mesh of a scenery: the light of its lamps with their
/// shadows, and what all surfaces throw back, the sun's light included, after two reflections
/// (radiosity gathered at the vertices by rays in fixed directions). Edges should be short where
/// light changes (see Tessellate). `scene` must be made from `scenery`. The result is the same for
/// any number of threads.
void BakeIrradiance(const RayScene& scene, const Light& light, Scenery* scenery);

}  // namespace orb360::town
