#pragma once

#include <optional>

#include <Eigen/Core>

#include "slam/map/map.h"

namespace orb360 {

/// Direction of "up" at the beginning of a map, unit, in its world: the normal of the plane that
/// the landmarks below the first keyframes' cameras lie on. The camera may be tilted by up to 45
/// degrees. Empty where no plane holds a good part of them.
std::optional<Eigen::Vector3d> EstimateUp(const Map& map);

}  // namespace orb360
