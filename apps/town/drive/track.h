#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "apps/town/drive/ride.h"

namespace orb360::town {

/// The outline of a vehicle or a person on the road, metres.
struct Footprint {
  double length = 0;
  double width = 0;
};

/// The moments at which moving objects are compared.
struct Moments {
  double from = 0;  ///< seconds
  double until = 0;
  static constexpr double kStep = 0.1;  // seconds: oncoming cars come nearer by 2.4 m at most

  int Count() const { return static_cast<int>((until - from) / kStep) + 1; }
  double At(int i) const { return from + kStep * i; }
};

/// The position of an object at each of the moments, as a row of discs with a margin around it.
struct Track {
  std::vector<Vector2d> positions;
  std::vector<Vector2d> forwards;  ///< unit
  double radius = 0;               ///< of a disc
  std::vector<double> discs;       ///< their middles, metres along, from the rearmost

  /// Returns the metres from the middle to the outermost margin.
  double Reach() const { return discs.back() + radius; }
};

Track TrackOf(const Ride& ride, const Footprint& footprint, const Moments& moments);
/// Updates the track for a changed ride from moment `first` up to, not including, moment `end`.
void Retrack(const Ride& ride, const Moments& moments, int first, int end, Track* track);
/// Returns the track of a person, who is one disc.
Track TrackOf(const std::function<Vector2d(double time)>& position, double radius,
              const Moments& moments);

/// Returns the first moment from `first` up to, not including, `end` at which the discs of two
/// tracks touch.
std::optional<int> FirstMeeting(const Track& a, const Track& b, int first, int end);
inline bool Meet(const Track& a, const Track& b) {
  return FirstMeeting(a, b, 0, static_cast<int>(a.positions.size())).has_value();
}

/// Finds the passes by which `ride`, which has none yet, overtakes those of `others` that it would
/// catch up with in its lane; the others keep their rides. Vehicles that come from behind, are
/// oncoming or cross are ignored. Returns nullopt if the ride would have to keep to the left for
/// too long.
std::optional<std::vector<Pass>> FindPasses(const Ride& ride, const Footprint& footprint,
                                            const std::vector<const Track*>& others,
                                            const Moments& moments);

}  // namespace orb360::town
