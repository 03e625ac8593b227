#include "apps/town/world/furnish.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "apps/town/world/cyclist.h"
#include "apps/town/world/furniture.h"
#include "apps/town/world/ground.h"
#include "apps/town/world/pedestrian.h"
#include "apps/town/world/planting.h"
#include "apps/town/world/tree.h"
#include "apps/town/world/vehicle.h"

namespace orb360::town {
namespace {

/// Indices of the town's models.
struct Models {
  std::vector<uint32_t> trees, lamps, signs, vehicles, hedges;
  std::vector<uint32_t> small;  ///< post boxes, hydrants, cabinets: stand anywhere by the kerb
  std::vector<uint32_t> columns, shelters;
  uint32_t traffic_light, bench, bin, bollard;
};

Models MakeModels(const Random& random, const Materials& m, Town* town) {
  const auto add = [town](Mesh mesh) {
    town->scenery.models.push_back(std::move(mesh));
    return static_cast<uint32_t>(town->scenery.models.size() - 1);
  };
  Models models;
  for (uint64_t i = 0; i < 6; ++i) models.trees.push_back(add(MakeTree(m, random.Fork(10 + i))));
  for (uint64_t i = 0; i < 2; ++i)
    models.lamps.push_back(add(MakeLampPost(m, random.Fork(20 + i))));
  for (uint64_t i = 0; i < 8; ++i)
    models.signs.push_back(add(MakeRoadSign(m, random.Fork(30 + i))));
  for (int i = 0; i < kVehicleKinds; ++i)
    models.vehicles.push_back(add(MakeVehicle(static_cast<VehicleKind>(i), m)));
  town->vehicles = models.vehicles;
  constexpr uint64_t kPeople = 8;
  for (uint64_t i = 0; i < kPeople; ++i) {
    for (uint32_t phase = 0; phase < kWalkPhases; ++phase) {
      const uint32_t model = add(MakePedestrian(phase, m, random.Fork(60 + i)));
      if (phase == 0) town->pedestrians.push_back(model);
    }
  }
  constexpr uint64_t kCyclists = 4;
  for (uint64_t i = 0; i < kCyclists; ++i) {
    for (uint32_t phase = 0; phase < kPedalPhases; ++phase) {
      const uint32_t model = add(MakeCyclist(phase, m, random.Fork(80 + i)));
      if (phase == 0) town->cyclists.push_back(model);
    }
  }
  for (uint64_t i = 0; i < 4; ++i) models.hedges.push_back(add(MakeBush(m, random.Fork(90 + i))));
  models.small = {add(MakePostBox(m)), add(MakeHydrant(m))};
  for (uint64_t i = 0; i < 3; ++i)
    models.small.push_back(add(MakeCabinet(m, random.Fork(100 + i))));
  for (uint64_t i = 0; i < 2; ++i)
    models.columns.push_back(add(MakeAdvertisingColumn(m, random.Fork(110 + i))));
  for (uint64_t i = 0; i < 2; ++i)
    models.shelters.push_back(add(MakeBusShelter(m, random.Fork(120 + i))));
  models.traffic_light = add(MakeTrafficLight(m));
  models.bench = add(MakeBench(m));
  models.bin = add(MakeBin(m));
  models.bollard = add(MakeBollard(m));
  return models;
}

/// Places objects along one side of a street.
class Side {
 public:
  Side(const Street& street, size_t index, double side, Town* town)
      : street_(&street), index_(index), side_(side), town_(town) {}

  /// Returns true if the place is at least `margin` metres from any other carriageway.
  bool Clear(double station, double margin) const {
    return station > 1 && station < street_->Length() - 1 &&
           town_->plan.DistanceToOtherRoads(street_->At(station).position, index_) > margin &&
           !town_->plan.IsUnderBridge(index_, station, 0.5 * margin);
  }
  /// Adds an instance `from_kerb` metres onto the pavement (negative: on the carriageway), turned
  /// by `yaw` from facing the carriageway.
  Instance& Place(uint32_t model, double station, double from_kerb, double yaw) {
    const StreetPoint p = street_->At(station);
    const Vector2d outward = side_ * Vector2d(-p.tangent.y(), p.tangent.x());
    const Vector2d q = p.position + (p.half_width + from_kerb) * outward;
    Instance instance;
    instance.model = model;
    const double height = town_->plan.Height(q) + (from_kerb > 0 ? kKerbHeight : 0);
    instance.world_from_model =
        Eigen::Translation3f(Eigen::Vector3d(q.x(), q.y(), height).cast<float>()) *
        Eigen::AngleAxisf(static_cast<float>(std::atan2(-outward.y(), -outward.x()) + yaw),
                          Vector3f::UnitZ());
    town_->scenery.instances.push_back(instance);
    return town_->scenery.instances.back();
  }

 private:
  const Street* street_;
  size_t index_;
  double side_;
  Town* town_;
};

void ParkCars(Side& side, const Street& street, const Models& models, const Town& town,
              Random& random) {
  if (!street.parking) return;
  double s = random.Uniform(2, 8);
  while (s < street.Length() - 6) {
    const VehicleKind kind = DrawVehicleKind(random);
    const double length = VehicleLength(kind);
    if (!side.Clear(s, 9) || !side.Clear(s + length, 9) || random.Chance(0.22)) {
      s += 3;
      continue;
    }
    // Along the street in the direction of the traffic on this side, which keeps right.
    constexpr double kAlong = -0.5 * std::numbers::pi;
    Instance& car =
        side.Place(models.vehicles[static_cast<size_t>(kind)], s + 0.5 * length,
                   -1.05 + random.Uniform(-0.12, 0.12), kAlong + random.Uniform(-0.03, 0.03));
    car.tint = DrawPaint(random);
    car.lookout = 2.4F;
    // The car is tilted with the road.
    const Vector3f forward = car.world_from_model.linear().col(0);
    const Vector3f place = car.world_from_model.translation();
    const auto height_at = [&](float along) {
      return town.plan.Height((place + along * forward).head<2>().cast<double>());
    };
    const auto slope = static_cast<float>(std::atan2(height_at(1.3F) - height_at(-1.3F), 2.6));
    car.world_from_model.rotate(Eigen::AngleAxisf(-slope, Vector3f::UnitY()));
    s += length + random.Uniform(0.6, 1.8);
  }
}

void FurnishSide(Side& side, const Street& street, const Models& models, const Town& town,
                 Random& random) {
  ParkCars(side, street, models, town, random);
  const auto pick = [&random](const std::vector<uint32_t>& from) {
    return from[static_cast<size_t>(random.Int(static_cast<int>(from.size())))];
  };
  if (street.pavement > 2.8 && random.Chance(0.75)) {
    for (double s = random.Uniform(3, 8); s < street.Length(); s += random.Uniform(8, 13)) {
      if (!side.Clear(s, 7)) continue;
      side.Place(pick(models.trees), s, 0.75, random.Uniform(0, 6.28)).lookout = 7;
    }
  }
  const uint32_t lamp = pick(models.lamps);
  for (double s = random.Uniform(2, 20); s < street.Length(); s += 27) {
    if (side.Clear(s, 5)) side.Place(lamp, s, 0.45, 0).lookout = 5;
  }
  for (double s = random.Uniform(5, 30); s < street.Length(); s += random.Uniform(15, 45)) {
    if (side.Clear(s, 5)) side.Place(pick(models.signs), s, 0.4, 0);
  }
  for (double s = random.Uniform(5, 30); s < street.Length(); s += random.Uniform(12, 50)) {
    if (!side.Clear(s, 5)) continue;
    if (random.Chance(0.5))
      side.Place(models.bin, s, 0.6, 0);
    else
      side.Place(models.bench, s, street.pavement - 0.5, 0);
  }
  for (double s = random.Uniform(4, 25); s < street.Length(); s += random.Uniform(14, 40)) {
    if (!side.Clear(s, 5)) continue;
    if (random.Chance(0.12) && street.pavement > 2.8)
      side.Place(pick(models.columns), s, 0.6, random.Uniform(0, 6.28)).lookout = 4;
    else
      side.Place(pick(models.small), s, 0.45, 0).lookout = 2;
  }
  if (street.pavement > 2.8 && random.Chance(0.3)) {
    const double s = random.Uniform(0.3, 0.7) * street.Length();
    if (side.Clear(s, 9)) side.Place(pick(models.shelters), s, 0.3, 0).lookout = 3;
  }
  if (random.Chance(0.3)) {
    for (double s = 2; s < street.Length(); s += 2.2) {
      if (side.Clear(s, 6)) side.Place(models.bollard, s, 0.3, 0);
    }
  }
}

}  // namespace

void FurnishStreets(const Random& random, const Materials& materials, Town* town) {
  const Models models = MakeModels(random, materials, town);
  for (size_t i = 0; i < town->plan.streets.size(); ++i) {
    for (const double sign : {1.0, -1.0}) {
      const Street& street = town->plan.streets[i];
      Side side(street, i, sign, town);
      Random side_random = random.Fork(1000 + 2 * i + (sign > 0 ? 0 : 1));
      FurnishSide(side, street, models, *town, side_random);
    }
  }
  const Plants plants{models.trees, models.hedges, models.bench};
  PlantIslands(plants, random.Fork(5), town);
  PlantParks(plants, random.Fork(6), town);
  // Traffic lights beside the stop lines.
  for (size_t index = 0; index < town->plan.junctions.size(); ++index) {
    if (town->plan.RoundaboutAt(index) != nullptr) continue;
    for (const Junction::Arm& arm : town->plan.junctions[index].arms) {
      const Street& street = town->plan.streets[arm.street];
      for (const double direction : {1.0, -1.0}) {
        double s = arm.station;
        while (s > 0 && s < street.Length() &&
               town->plan.DistanceToOtherRoads(street.At(s).position, arm.street) < 4.5)
          s += 0.5 * direction;
        if (s < 2 || s > street.Length() - 2) continue;
        // The light is visible to those who drive towards the junction on the right.
        Side side(street, arm.street, direction > 0 ? 1.0 : -1.0, town);
        side.Place(models.traffic_light, s, 0.5, 0);
      }
    }
  }
}

}  // namespace orb360::town
