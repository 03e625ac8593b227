#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "apps/town/world/street_plan.h"

namespace orb360::town {

struct LapOptions {
  uint64_t seed = 0;
  double minimum_speed = 6.5;  ///< metres per second, what drivers wish for on straight stretches
  double maximum_speed = 12;
  double stop_share = 0.15;  ///< of the junctions, where the driver waits
};

/// Metres to the left of a line at three places along it.
struct Lateral {
  double rear = 0;
  double middle = 0;
  double front = 0;
};

/// Where a car is in the plan.
struct RoadPlace {
  Vector2d position;
  Vector2d forward;  ///< unit
};

/// A car's standing on the road.
struct RoadPose : RoadPlace {
  double height = 0;  ///< of the road below
  double slope = 0;   ///< radians, nose up
  double bank = 0;    ///< radians, left side up
};

/// One round of a closed tour in the right-hand lanes, driven again and again: the line, and the
/// speed at each point, slowing down for bends and stopping at some junctions. All cars of a
/// stream drive the same lap at different times, so they keep their distances.
class Lap {
 public:
  /// `tour`: junctions in order, neighbours joined by a street, the last with the first.
  Lap(const StreetPlan& plan, std::span<const size_t> tour, const LapOptions& options);

  struct State {
    double station = 0;  ///< metres along the line, in [0, length)
    double speed = 0;    ///< metres per second
  };
  double length() const;                         ///< metres
  double duration() const { return duration_; }  ///< seconds
  /// At any time, negative too, in seconds.
  State At(double time) const;
  /// Seconds after the lap's start at which the car leaves `station` (any number, it wraps).
  double TimeAt(double station) const;
  /// Metres from the line to the kerb on the right, or to the cars parked there.
  double RoomOnRight(double station) const;
  /// The car's place with its middle at `station` (any number, it wraps), beside the line by `left`
  /// at its middle and at half a wheelbase behind and before.
  RoadPlace PlaceAt(double station, const Lateral& left = {}) const;
  /// As above, on the terrain.
  RoadPose PoseAt(double station, const Lateral& left = {}) const;
  static constexpr double kHalfWheelbase = 1.4;  // metres

 private:
  Vector2d Point(double station, double left) const;

  const StreetPlan* plan_;
  std::vector<Vector2d> points_;  // every kStep metres
  std::vector<double> room_;      // on the right there
  std::vector<double> speeds_;    // there
  std::vector<double> dwell_;     // seconds spent standing there
  std::vector<double> arrivals_;  // seconds since the lap's start
  double duration_ = 0;
};

}  // namespace orb360::town
