#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "apps/town/drive/lap.h"
#include "apps/town/drive/ride.h"
#include "apps/town/drive/track.h"
#include "apps/town/drive/walker.h"
#include "apps/town/world/town.h"

namespace orb360::town {

struct TrafficOptions {
  uint64_t seed = 0;
  double density = 0;  ///< 0 none to 1 dense
  double from = 0;     ///< seconds; the time in which nothing may meet
  double until = 0;
};

/// Kinds of drivers, slower ones first. A driver passes those of a lower rank.
enum class Pace : uint8_t { kStanding, kCycling, kSlow, kNormal, kFast };

/// A vehicle in traffic.
struct Mover {
  Ride ride;
  Pace pace = Pace::kNormal;
  Footprint footprint;
  uint32_t model = 0;  ///< of a cyclist the first of kPedalPhases
  Rgba tint;
};

/// All that moves in a town besides the camera's car: cars and vans before and behind it, oncoming
/// ones and ones on other streets, cyclists and slow vans that it passes, vans that stand in the
/// lane, cars that overtake it, and pedestrians on the pavements. It is a pure function of time.
/// Objects that would collide between `from` and `until` are left out.
class Traffic {
 public:
  /// `own_lap` is the lap of the camera's car. The lap and the town are kept by reference.
  Traffic(const Town& town, const Lap& own_lap, const TrafficOptions& options);

  /// The ride of the camera's car, with the passes that the others require.
  const Ride& own() const { return own_; }
  const std::vector<Mover>& movers() const { return movers_; }
  const std::vector<Walker>& walkers() const { return walkers_; }

  /// Returns all moving objects, always in the same order, at a time in seconds.
  std::vector<Instance> At(double time) const;

 private:
  Instance Place(const Mover& mover, double time) const;
  Instance Place(size_t walker, double time) const;

  const Town* town_;
  std::deque<Lap> laps_;  // pointed at by rides
  Ride own_;
  std::vector<Mover> movers_;
  std::vector<Walker> walkers_;
  std::vector<uint32_t> walker_models_;
};

}  // namespace orb360::town
