#include "apps/town/world/planting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/town/world/ground.h"
#include "apps/town/world/landmarks.h"

namespace orb360::town {
namespace {

/// Places a model on the ground, `above` the terrain, facing along `direction`.
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

}  // namespace

void PlantIslands(const Plants& plants, Random random, Town* town) {
  for (const Island& island : town->plan.islands) {
    if (island.spine.size() == 1) {
      const Vector2d& centre = island.spine.front();
      Stand(random.Pick(plants.trees), centre, kGrass, DrawDirection(random), town).lookout = 7;
      const double radius = island.radius - 1.6;
      const int pieces = static_cast<int>(2 * std::numbers::pi * radius);
      for (int i = 0; i < pieces; ++i) {
        const double angle = 2 * std::numbers::pi * i / pieces;
        const Vector2d out(std::cos(angle), std::sin(angle));
        Stand(random.Pick(plants.hedges), centre + radius * out, kGrass, {-out.y(), out.x()}, town)
            .lookout = 1.5F;
      }
      continue;
    }
    constexpr size_t kEvery = 4;  // points of the spine, 2 m apart
    for (size_t i = 1; i + 1 < island.spine.size(); i += kEvery)
      Stand(random.Pick(plants.trees), island.spine[i], kGrass, DrawDirection(random), town)
          .lookout = 7;
  }
}

void PlantParks(const Plants& plants, Random random, Town* town) {
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
    // A hedge about every metre where the lawn begins: on the lines between cells whose corners are
    // on either side of it.
    constexpr double kSpacing = 0.9;
    constexpr double kHedge = 0.8;  // metres behind the pavement
    const auto behind = [&](const Vector2d& p) {
      return plan.DistanceToRoad(p) - plan.PavementAt(p) - kHedge;
    };
    const Eigen::Vector2i cells = ((high - low) / kSpacing).cast<int>();
    for (int row = 0; row <= cells.y(); ++row) {
      for (int column = 0; column <= cells.x(); ++column) {
        const Vector2d p = low + kSpacing * Vector2d(column, row);
        if (!park.Contains(p)) continue;
        const double distance = behind(p);
        if (std::abs(distance) > 0.5 * kSpacing || path_distance(p) < 0.8) continue;
        constexpr double kDelta = 0.3;
        const Vector2d slope(behind(p + Vector2d(kDelta, 0)) - behind(p - Vector2d(kDelta, 0)),
                             behind(p + Vector2d(0, kDelta)) - behind(p - Vector2d(0, kDelta)));
        const Vector2d out = slope.normalized();
        Stand(random.Pick(plants.hedges), p - distance * out, kGrass, {-out.y(), out.x()}, town)
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
      Stand(random.Pick(plants.trees), p, kGrass, DrawDirection(random), town).lookout = 7;
    }
    for (size_t i = 0; i < park.gates.size(); ++i) {
      const Vector2d between = (park.gates[i] - park.centre).normalized() +
                               (park.gates[(i + 1) % park.gates.size()] - park.centre).normalized();
      const Vector2d out = between.normalized();
      Stand(plants.bench, park.centre + (kParkCircle - 0.6) * out, kKerbHeight, -out, town);
    }
  }
}

}  // namespace orb360::town
