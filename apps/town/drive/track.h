#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "apps/town/drive/ride.h"

namespace orb360::town {

/// A vehicle's or a person's outline on the road, metres.
struct Footprint {
  double length = 0;
  double width = 0;
};

/// Moments at which moving things are compared.
struct Moments {
  double from = 0;  ///< seconds
  double until = 0;
  static constexpr double kStep = 0.1;  // seconds: oncoming cars come nearer by 2.4 m at most

  int Count() const { return static_cast<int>((until - from) / kStep) + 1; }
  double At(int i) const { return from + kStep * i; }
};

/// Where something is at each of the moments, as discs in a row with some air around them.
struct Track {
  std::vector<Vector2d> positions;
  std::vector<Vector2d> forwards;  ///< unit
  double radius = 0;               ///< of a disc
  std::vector<double> discs;       ///< their middles, metres along, from the rearmost

  /// Metres from the middle to the outermost air.
  double Reach() const { return discs.back() + radius; }
};

Track TrackOf(const Ride& ride, const Footprint& footprint, const Moments& moments);
/// Follows a changed ride from one moment up to, not including, another.
void Retrack(const Ride& ride, const Moments& moments, int first, int end, Track* track);
/// Of a person, who is one disc.
Track TrackOf(const std::function<Vector2d(double time)>& position, double radius,
              const Moments& moments);

/// The first moment from `first` up to, not including, `end` at which the discs of two tracks
/// touch.
std::optional<int> FirstMeeting(const Track& a, const Track& b, int first, int end);
inline bool Meet(const Track& a, const Track& b) {
  return FirstMeeting(a, b, 0, static_cast<int>(a.positions.size())).has_value();
}

/// How `ride`, which has no passes yet, gets past those of `others` that it would catch up with on
/// its lane; they stay as they are. Those that come up from behind, are oncoming or cross are not
/// heeded. None where it would keep to the left for too long.
std::optional<std::vector<Pass>> FindPasses(const Ride& ride, const Footprint& footprint,
                                            const std::vector<const Track*>& others,
                                            const Moments& moments);

}  // namespace orb360::town
