#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/drive/lap.h"
#include "apps/town/world/town.h"

namespace orb360::town {

struct TrafficOptions {
  uint64_t seed = 0;
  double density = 0;  ///< 0 none to 1 dense
  double from = 0;     ///< seconds; the time in which no two cars may meet
  double until = 0;
};

/// What moves in a town: cars before and behind the camera's car and oncoming ones, all on laps of
/// the tour, and pedestrians on the pavements. A pure function of time. Cars that would run into
/// one another where the tour meets itself are left out.
class Traffic {
 public:
  /// `own_lap` is the lap the camera's car drives at time offset 0. All references are kept.
  Traffic(const Town& town, const Lap& own_lap, const Lap& oncoming_lap,
          const TrafficOptions& options);

  /// Everything that moves, always in the same order, at a time in seconds.
  std::vector<Instance> At(double time) const;

 private:
  struct Car {
    const Lap* lap;
    double offset;  ///< seconds ahead on the lap
    uint32_t model;
    Rgba tint;
  };
  struct Pedestrian {
    size_t street;
    double side;       ///< +1 left of increasing station, -1 right
    double from_kerb;  ///< metres
    double start;      ///< station at time 0
    double speed;      ///< metres per second, negative towards decreasing station
    uint32_t first_model;
    Rgba tint;
  };

  void AddCars(const Lap& lap, const TrafficOptions& options, uint64_t seed);
  bool Collide(const Car& a, const Car& b, const TrafficOptions& options) const;
  Instance Place(const Car& car, double time) const;
  Instance Place(const Pedestrian& pedestrian, double time) const;

  const Town* town_;
  std::vector<Car> cars_;
  std::vector<Pedestrian> pedestrians_;
};

}  // namespace orb360::town
