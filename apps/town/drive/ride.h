#pragma once

#include <optional>
#include <vector>

#include "apps/town/drive/lap.h"

namespace orb360::town {

/// A stretch on which a vehicle drives farther to the left to pass a slower one.
struct Pass {
  double begin = 0;  ///< metres along the lap, as Ride::DistanceAt; ramps lie outside
  double end = 0;
  double left = 0;  ///< metres
};

/// A vehicle slows down for others, perhaps to a stop.
struct Delay {
  double begin = 0;  ///< seconds
  double end = 0;
  double lost = 0;  ///< seconds later than without it, at the end; less than 2/3 of the duration
};

/// The motion of one vehicle over a lap, a pure function of time.
struct Ride {
  const Lap* lap = nullptr;
  double ahead = 0;                        ///< seconds before the lap's own clock
  std::optional<double> from_kerb = {};    ///< keeps right, its middle so many metres from the kerb
                                           ///< or the parked cars; none: on the lap's line
  std::optional<double> standing_at = {};  ///< stands there, metres along the lap
  std::vector<Pass> passes = {};
  std::vector<Delay> delays = {};  ///< one after the other

  /// Returns the metres along the lap, which keep growing from lap to lap.
  double DistanceAt(double time) const;
  double SpeedAt(double time) const;  ///< metres per second
  /// Returns the metres to the left of the lap's line.
  double LeftAt(double distance) const;
  RoadPlace PlaceAt(double time) const;
  RoadPose PoseAt(double time) const;

 private:
  double LapTime(double time) const;
  Lateral LateralAt(double distance) const;
};

}  // namespace orb360::town
