#pragma once

#include "apps/town/render/ray_scene.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// Computes for every vertex of a scenery the fraction of the sky that it sees (Vertex::openness):
/// rays over the hemisphere above the surface, weighted by the cosine (ambient occlusion). Vertices
/// of models see their own model on level ground; each instance is then dimmed as a whole by what
/// it sees from its place. A fixed mesh with irradiance is left as it is. `scene` must be made from
/// `scenery`.
void BakeOpenness(const RayScene& scene, Scenery* scenery);

}  // namespace orb360::town
