#pragma once

#include <cstddef>

#include "apps/town/image/random.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// A person who walks up and down the pavement on one side of a street.
struct Walker {
  size_t street = 0;
  double side = 1;       ///< +1 left of increasing station, -1 right
  double from_kerb = 1;  ///< metres
  double from = 0;       ///< station where they turn round
  double to = 1;         ///< likewise, at the other end
  double start = 0;      ///< metres behind `from` at time 0
  double speed = 1.3;    ///< metres per second, negative where first walking to lower stations

  struct State {
    Vector2d position;
    Vector2d forward;   ///< unit
    double walked = 0;  ///< metres since time 0, may be negative
  };
  State At(const StreetPlan& plan, double time) const;
};

Walker DrawWalker(const StreetPlan& plan, size_t street, Random& random);

}  // namespace orb360::town
