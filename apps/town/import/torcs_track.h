#pragma once

#include <vector>

#include <Eigen/Core>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// The middle of the road of a circuit of the TORCS racing simulator, once round, in the axes of
/// the file. The simulator's track generator names the pieces of the road TKMN and a number that
/// grows along the circuit, and lists their vertices in pairs across the road. Empty if there are
/// no such pieces.
std::vector<Eigen::Vector3f> FindTorcsCentreline(const SourceScene& scene);

}  // namespace orb360::town
