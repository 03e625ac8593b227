#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// A point of the driven line: x and y in the plan, and as z the metres to the kerb on the right,
/// or to the cars parked there.
using LinePoint = Eigen::Vector3d;

/// Returns the line on which a closed tour (see Lap) is driven, as a ring: the right-hand lanes,
/// joined by curves at junctions, and round the islands of roundabouts. `junction_points` receives
/// the indices of the points at which the curves begin.
std::vector<LinePoint> DrivenLine(const StreetPlan& plan, std::span<const size_t> tour,
                                  std::vector<size_t>* junction_points);

}  // namespace orb360::town
