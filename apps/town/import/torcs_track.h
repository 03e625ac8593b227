#pragma once

#include <vector>

#include <Eigen/Core>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// Returns the middle of the road of a circuit of the TORCS racing simulator, once round in driving
/// direction, in the axes of the file; the first point is not repeated. The simulator's track
/// generator names the pieces of the road TKMN with a number that mostly grows along the circuit,
/// and lists their vertices in pairs across the road. Pieces are joined where their ends meet, not
/// by their numbers, because tools that edit circuits leave these out of order. Returns an empty
/// vector if there are no such pieces or they do not close a ring.
std::vector<Eigen::Vector3f> FindTorcsCentreline(const SourceScene& scene);

}  // namespace orb360::town
