#pragma once

#include <vector>

#include "apps/town/drive/route_walk.h"
#include "apps/town/image/random.h"
#include "apps/town/world/interior/floor_plan.h"

namespace orb360::town {

struct WalkOptions {
  double speed = 1;      ///< metres per second where the way is straight
  double duration = 60;  ///< seconds; the walk is at least so long
};

/// A walk through the rooms of a storey and back again: from room to room in an order drawn anew
/// each time round, through the doorways, around the furniture, slower in bends.
class IndoorWalk {
 public:
  static constexpr float kClearance = 0.27F;  ///< metres kept from walls and furniture

  IndoorWalk(const FloorPlan& plan, const std::vector<Area>& taken, const WalkOptions& options,
             const Random& random);

  /// Returns the state at a time in seconds, clamped to the walk.
  WalkState At(double time) const { return walk_.At(time); }
  double duration() const { return walk_.duration(); }

 private:
  RouteWalk walk_;
};

}  // namespace orb360::town
