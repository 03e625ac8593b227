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
  double stop_fraction = 0.15;  ///< of the junctions, where the driver waits
};

/// Distances to the left of a line at three places along it, metres.
struct Lateral {
  double rear = 0;
  double middle = 0;
  double front = 0;
};

/// Position and direction of a car in the plan.
struct RoadPlace {
  Vector2d position;
  Vector2d forward;  ///< unit
};

/// Position and attitude of a car on the road.
struct RoadPose : RoadPlace {
  double height = 0;  ///< of the road below
  double slope = 0;   ///< radians, nose up
  double bank = 0;    ///< radians, left side up
};

/// One round of a closed tour in the right-hand lanes, driven repeatedly: the line, and the speed
/// at each point, with slower bends and stops at some junctions. All cars of a stream drive the
/// same lap at different times, so they keep their distances.
class Lap {
 public:
  /// `tour` lists junctions in order. A street joins each with the next one, and the last with the
  /// first.
  Lap(const StreetPlan& plan, std::span<const size_t> tour, const LapOptions& options);

  struct State {
    double station = 0;  ///< metres along the line, in [0, length)
    double speed = 0;    ///< metres per second
  };
  double length() const;                         ///< metres
  double duration() const { return duration_; }  ///< seconds
  /// Returns the state at any time, in seconds, which may be negative.
  State At(double time) const;
  /// Returns the time after the lap's start, in seconds, at which the car leaves `station` (any
  /// number, it wraps).
  double TimeAt(double station) const;
  /// Returns the metres from the line to the kerb on the right, or to the cars parked there.
  double RoomOnRight(double station) const;
  /// Returns the car's place with its middle at `station` (any number, it wraps). `left` is its
  /// distance from the line at its middle and at half a wheelbase behind and before.
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
