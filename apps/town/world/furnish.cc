#include "apps/town/world/furnish.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "apps/town/world/cyclist.h"
#include "apps/town/world/furniture.h"
#include "apps/town/world/ground.h"
#include "apps/town/world/landmarks.h"
#include "apps/town/world/pedestrian.h"
#include "apps/town/world/tree.h"
#include "apps/town/world/vehicle.h"

namespace orb360::town {
namespace {

/// Indices of the town's models.
struct Models {
  std::vector<uint32_t> trees, lamps, signs, vehicles, hedges;
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
  models.traffic_light = add(MakeTrafficLight(m));
  models.bench = add(MakeBench(m));
  models.bin = add(MakeBin(m));
  models.bollard = add(MakeBollard(m));
  return models;
}

/// Places things along one side of a street.
class Side {
 public:
  Side(const Street& street, size_t index, double side, Town* town)
      : street_(&street), index_(index), side_(side), town_(town) {}

  /// Whether the place is at least `margin` metres from any other carriageway.
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
    const int kind = random.Chance(0.1) ? 3 : random.Int(3);
    const double length = VehicleLength(static_cast<VehicleKind>(kind));
    if (!side.Clear(s, 9) || !side.Clear(s + length, 9) || random.Chance(0.22)) {
      s += 3;
      continue;
    }
    // Along the street, in the direction of the traffic on this side (which keeps right).
    constexpr double kAlong = -0.5 * std::numbers::pi;
    Instance& car =
        side.Place(models.vehicles[static_cast<size_t>(kind)], s + 0.5 * length,
                   -1.05 + random.Uniform(-0.12, 0.12), kAlong + random.Uniform(-0.03, 0.03));
    car.tint = DrawPaint(random);
    car.lookout = 2.4F;
    // Tilted with the road.
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
  if (random.Chance(0.3)) {
    for (double s = 2; s < street.Length(); s += 2.2) {
      if (side.Clear(s, 6)) side.Place(models.bollard, s, 0.3, 0);
    }
  }
}

/// Stands a model on the ground, `above` the terrain, facing along `direction`.
Instance& Stand(uint32_t model, const Vector2d& p, double above, const Vector2d& direction,
                Town* town) {
  Instance instance;
  instance.model = model;
  instance.world_from_model =
      Eigen::Translation3f(
          Eigen::Vector3d(p.x(), p.y(), town->plan.Height(p) + above).cast<float>()) *
      Eigen::AngleAxisf(static_cast<float>(std::atan2(direction.y(), direction.x())),
                        Vector3f::UnitZ());
  town->scenery.instances.push_back(instance);
  return town->scenery.instances.back();
}

Vector2d DrawDirection(Random& random) {
  const double angle = random.Uniform(0, 2 * std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

constexpr double kGrass = kKerbHeight - 0.02;  // metres above the terrain

/// Trees in a row on medians; a tree within a ring of hedge on the islands of roundabouts.
void PlantIslands(const Models& models, Random random, Town* town) {
  const std::span<const uint32_t> trees(models.trees);
  const std::span<const uint32_t> hedges(models.hedges);
  for (const Island& island : town->plan.islands) {
    if (island.spine.size() == 1) {
      const Vector2d& centre = island.spine.front();
      Stand(random.Pick(trees), centre, kGrass, DrawDirection(random), town).lookout = 7;
      const double radius = island.radius - 1.6;
      const int pieces = static_cast<int>(2 * std::numbers::pi * radius);
      for (int i = 0; i < pieces; ++i) {
        const double angle = 2 * std::numbers::pi * i / pieces;
        const Vector2d out(std::cos(angle), std::sin(angle));
        Stand(random.Pick(hedges), centre + radius * out, kGrass, {-out.y(), out.x()}, town)
            .lookout = 1.5F;
      }
      continue;
    }
    constexpr size_t kEvery = 4;  // points of the spine, 2 m apart
    for (size_t i = 1; i + 1 < island.spine.size(); i += kEvery)
      Stand(random.Pick(trees), island.spine[i], kGrass, DrawDirection(random), town).lookout = 7;
  }
}

/// Trees on the lawn, a hedge along the pavements but at the gates, benches about the centre.
void PlantParks(const Models& models, Random random, Town* town) {
  const StreetPlan& plan = town->plan;
  for (const Park& park : plan.parks) {
    Vector2d low = park.outline.front();
    Vector2d high = low;
    for (const Vector2d& p : park.outline) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const auto path_distance = [&](const Vector2d& p) {
      double distance = (p - park.centre).norm() - kParkCircle;
      for (const Vector2d& gate : park.gates)
        distance = std::min(distance, Island{{park.centre, gate}, 0, kPathHalfWidth}.Distance(p));
      return distance;
    };
    // A hedge about every metre where the lawn begins: what lies on the line between cells whose
    // corners are on either side of it.
    constexpr double kSpacing = 0.9;
    constexpr double kHedge = 0.8;  // metres behind the pavement
    const auto behind = [&](const Vector2d& p) {
      return plan.DistanceToRoad(p) - plan.PavementAt(p) - kHedge;
    };
    for (double y = low.y(); y < high.y(); y += kSpacing) {
      for (double x = low.x(); x < high.x(); x += kSpacing) {
        const Vector2d p(x, y);
        if (!park.Contains(p)) continue;
        const double distance = behind(p);
        if (std::abs(distance) > 0.5 * kSpacing || path_distance(p) < 0.8) continue;
        constexpr double kDelta = 0.3;
        const Vector2d slope(behind(p + Vector2d(kDelta, 0)) - behind(p - Vector2d(kDelta, 0)),
                             behind(p + Vector2d(0, kDelta)) - behind(p - Vector2d(0, kDelta)));
        const Vector2d out = slope.normalized();
        Stand(random.Pick(std::span<const uint32_t>(models.hedges)), p - distance * out, kGrass,
              {-out.y(), out.x()}, town)
            .lookout = 1.5F;
      }
    }
    std::vector<Vector2d> trees;
    constexpr int kTries = 120;
    for (int i = 0; i < kTries; ++i) {
      const Vector2d p(random.Uniform(low.x(), high.x()), random.Uniform(low.y(), high.y()));
      if (!park.Contains(p) || behind(p) < 2 || path_distance(p) < 0.8) continue;
      const bool is_free = std::none_of(trees.begin(), trees.end(), [&](const Vector2d& other) {
        return (other - p).norm() < 5;
      });
      if (!is_free) continue;
      trees.push_back(p);
      Stand(random.Pick(std::span<const uint32_t>(models.trees)), p, kGrass, DrawDirection(random),
            town)
          .lookout = 7;
    }
    for (size_t i = 0; i < park.gates.size(); ++i) {
      const Vector2d between = (park.gates[i] - park.centre).normalized() +
                               (park.gates[(i + 1) % park.gates.size()] - park.centre).normalized();
      const Vector2d out = between.normalized();
      Stand(models.bench, park.centre + (kParkCircle - 0.6) * out, kKerbHeight, -out, town);
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
  PlantIslands(models, random.Fork(5), town);
  PlantParks(models, random.Fork(6), town);
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
        // Seen by those who drive towards the junction on the right.
        Side side(street, arm.street, direction > 0 ? 1.0 : -1.0, town);
        side.Place(models.traffic_light, s, 0.5, 0);
      }
    }
  }
}

}  // namespace orb360::town
