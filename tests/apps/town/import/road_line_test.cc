#include "apps/town/import/road_line.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "apps/town/world/scenery.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr double kRadius = 50;
constexpr double kGround = 3;  // metres above the sections' plane

/// Adds a rectangle; corners are counter-clockwise seen from the front.
void AddQuad(const std::array<Vector3f, 4>& corners, Scenery* scenery) {
  const auto first = static_cast<uint32_t>(scenery->fixed.positions.size());
  for (const Vector3f& corner : corners) {
    scenery->fixed.positions.push_back(corner);
    scenery->fixed.vertices.emplace_back();
  }
  scenery->fixed.triangles.push_back({{first, first + 1, first + 2}});
  scenery->fixed.triangles.push_back({{first, first + 2, first + 3}});
}

/// A level ground, without the half plane y < -`gap`.
Scenery Ground(float gap) {
  Scenery scenery;
  scenery.palette.textures.emplace_back(1, 1, std::vector<Rgba>{Rgba{1, 1, 1, 1}});
  scenery.palette.all.emplace_back();
  const auto z = static_cast<float>(kGround);
  AddQuad(
      {Vector3f(-99, -gap, z), Vector3f(99, -gap, z), Vector3f(99, 99, z), Vector3f(-99, 99, z)},
      &scenery);
  return scenery;
}

std::vector<Eigen::Vector3d> Follow(Scenery scenery) {
  std::vector<RoadWidth> ring;  // counter-clockwise, a little below the ground
  for (int degrees = 0; degrees < 360; degrees += 5) {
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d height(0, 0, kGround - 0.7);
    ring.push_back({(kRadius - 4) * out + height, (kRadius + 4) * out + height});
  }
  scenery.fixed.PartitionCutouts(scenery.palette);
  const RayScene scene(scenery);
  return FollowRoad(scene, ring, 1.5);
}

TEST(FollowRoad, KeepsItsHeightAboveTheSurfaceAndTheMiddle) {
  const std::vector<Eigen::Vector3d> places = Follow(Ground(99));
  ASSERT_GT(places.size(), 300U);
  for (size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(places[i].z(), kGround + 1.5, 1e-4);
    EXPECT_NEAR(places[i].head<2>().norm(), kRadius, 0.3);
    EXPECT_LE((places[(i + 1) % places.size()] - places[i]).norm(), 1.01);
  }
}

TEST(FollowRoad, CrossesGapsOnALineBetweenTheirSides) {
  const std::vector<Eigen::Vector3d> places = Follow(Ground(45));
  ASSERT_GT(places.size(), 300U);
  for (const Eigen::Vector3d& place : places) EXPECT_NEAR(place.z(), kGround + 1.5, 1e-4);
}

TEST(FollowRoad, RefusesRoadsOfNoLengthAndOfImpossibleSize) {
  const Scenery scenery = Ground(99);
  const RayScene scene(scenery);
  const auto road = [](double radius, double half_width) {
    std::vector<RoadWidth> ring;
    for (int i = 0; i < 8; ++i) {
      const double angle = i * std::numbers::pi / 4;
      const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
      ring.push_back({(radius - half_width) * out, (radius + half_width) * out});
    }
    return ring;
  };
  EXPECT_THROW(FollowRoad(scene, road(0, 0), 1.5), UserError);
  EXPECT_THROW(FollowRoad(scene, road(1e9, 4), 1.5), UserError);
  EXPECT_THROW(FollowRoad(scene, road(1e4, 5e3), 1.5), UserError);
  EXPECT_THROW(FollowRoad(scene, road(std::nan(""), 4), 1.5), UserError);
  EXPECT_THROW(FollowRoad(scene, {}, 1.5), UserError);
}

TEST(FollowRoad, SwervesRoundWhatStandsInTheMiddle) {
  Scenery scenery = Ground(99);
  // A wall across the road's middle at the angle 0, from 49 to 51 metres.
  AddQuad({Vector3f(49, 0, 0), Vector3f(51, 0, 0), Vector3f(51, 0, 9), Vector3f(49, 0, 9)},
          &scenery);
  const std::vector<Eigen::Vector3d> places = Follow(scenery);
  double nearest = 99;
  for (size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d& a = places[i];
    const Eigen::Vector3d& b = places[(i + 1) % places.size()];
    if (a.x() < 0 || a.y() * b.y() > 0) continue;
    nearest = std::min(nearest, std::abs(a.x() - kRadius));
  }
  EXPECT_GT(nearest, 1.5);
  EXPECT_LT(nearest, 4);
}

}  // namespace
}  // namespace orb360::town
