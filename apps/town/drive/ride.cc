#include "apps/town/drive/ride.h"

#include <algorithm>
#include <cmath>

namespace orb360::town {
namespace {

/// Returns the fraction of a pass's lateral shift at a distance: 0 outside the ramps, 1 between
/// them.
double ShiftFraction(const Pass& pass, double distance) {
  // Length over which the car changes sides, metres. At 10 m/s the lateral acceleration is then
  // below 5 m/s².
  const double ramp = 8 + 4.5 * pass.left;
  const double outside = std::max({pass.begin - distance, distance - pass.end, 0.0});
  const double t = std::max(0.0, 1 - outside / ramp);
  return t * t * t * (t * (6 * t - 15) + 10);
}

}  // namespace

double Ride::LapTime(double time) const {
  double lap_time = time + ahead;
  for (const Delay& delay : delays) {
    const double t = std::clamp((time - delay.begin) / (delay.end - delay.begin), 0.0, 1.0);
    lap_time -= delay.lost * t * t * (3 - 2 * t);
  }
  return lap_time;
}

double Ride::DistanceAt(double time) const {
  if (standing_at) return *standing_at;
  const double lap_time = LapTime(time);
  const double laps = std::floor(lap_time / lap->duration());
  return lap->length() * laps + lap->At(lap_time).station;
}

double Ride::SpeedAt(double time) const {
  if (standing_at) return 0;
  double rate = 1;
  for (const Delay& delay : delays) {
    const double t = std::clamp((time - delay.begin) / (delay.end - delay.begin), 0.0, 1.0);
    rate -= delay.lost * 6 * t * (1 - t) / (delay.end - delay.begin);
  }
  return rate * lap->At(LapTime(time)).speed;
}

double Ride::LeftAt(double distance) const {
  const double right = from_kerb ? std::max(0.0, lap->RoomOnRight(distance) - *from_kerb) : 0;
  double left = 0;
  for (const Pass& pass : passes) left = std::max(left, pass.left * ShiftFraction(pass, distance));
  return left - right;
}

Lateral Ride::LateralAt(double distance) const {
  return {LeftAt(distance - Lap::kHalfWheelbase), LeftAt(distance),
          LeftAt(distance + Lap::kHalfWheelbase)};
}

RoadPlace Ride::PlaceAt(double time) const {
  const double distance = DistanceAt(time);
  return lap->PlaceAt(distance, LateralAt(distance));
}

RoadPose Ride::PoseAt(double time) const {
  const double distance = DistanceAt(time);
  return lap->PoseAt(distance, LateralAt(distance));
}

}  // namespace orb360::town
