#include "apps/town/import/walk_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/town/import/camera_path.h"
#include "tests/apps/town/plain_materials.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using ::testing::HasSubstr;

/// Adds the rectangle with the corners a and b, of which one coordinate is equal.
void AddRectangle(const Vector3f& a, const Vector3f& b, Mesh* mesh, MaterialId material = 0) {
  int axis = 0;
  while (a[axis] != b[axis]) ++axis;
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  for (const auto& [u, v] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
    Vector3f p = a;
    if (u == 1) p[(axis + 1) % 3] = b[(axis + 1) % 3];
    if (v == 1) p[(axis + 2) % 3] = b[(axis + 2) % 3];
    mesh->positions.push_back(p);
    mesh->vertices.emplace_back();
  }
  mesh->triangles.push_back({{first, first + 1, first + 2}, material});
  mesh->triangles.push_back({{first, first + 2, first + 3}, material});
}

void AddBox(const Vector3f& low, const Vector3f& high, Mesh* mesh) {
  for (int axis = 0; axis < 3; ++axis) {
    Vector3f a = high;
    Vector3f b = low;
    a[axis] = low[axis];
    AddRectangle(low, a, mesh);
    b[axis] = high[axis];
    AddRectangle(b, high, mesh);
  }
}

constexpr float kDoorLow = 2.4F;  // of y
constexpr float kDoorHigh = 3.5F;
constexpr float kUpper = 1;  // metres; the floor of the second room

/// Two rooms of 6 x 6 m. A door, and stairs of 0.2 m behind it, lead from the first one (x < 0) to
/// the second one, whose floor is higher. A platform in the first room cannot be reached.
Scenery TwoRooms() {
  Scenery scenery;
  scenery.palette = PlainMaterials();
  Mesh& mesh = scenery.fixed;
  AddBox({-6, 0, -0.2F}, {0.2F, 6, 0}, &mesh);
  AddRectangle({-6, 0, 4}, {8, 6, 4}, &mesh);
  for (const float y : {0.F, 6.F}) AddRectangle({-6, y, 0}, {8, y, 4}, &mesh);
  for (const float x : {-6.F, 8.F}) AddRectangle({x, 0, 0}, {x, 6, 4}, &mesh);
  AddBox({0, 0, 0}, {0.2F, kDoorLow, 4}, &mesh);
  AddBox({0, kDoorHigh, 0}, {0.2F, 6, 4}, &mesh);
  AddBox({0, kDoorLow, 2.3F}, {0.2F, kDoorHigh, 4}, &mesh);
  for (int i = 0; i < 5; ++i) {
    const float x = 0.2F + 0.3F * static_cast<float>(i);
    AddBox({x, 0, -0.2F}, {x + 0.3F, 6, 0.2F * static_cast<float>(i)}, &mesh);
  }
  AddBox({1.7F, 0, -0.2F}, {8, 6, kUpper}, &mesh);
  AddBox({-5.5F, 0.5F, 0}, {-3, 3, 0.6F}, &mesh);
  scenery.fixed.PartitionCutouts(scenery.palette);
  return scenery;
}

bool IsOnPlatform(const Eigen::Vector3d& p) {
  return p.x() > -5.5 && p.x() < -3 && p.y() > 0.5 && p.y() < 3;
}

Walk WalkIn(const Scenery& scenery, const WalkOptions& options) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& p : scenery.fixed.positions) box.extend(p);
  box.min().array() -= 0.5F;
  box.max().array() += 0.5F;
  return WalkThrough(RayScene(scenery), box, options);
}

std::string Problem(const Scenery& scenery, const WalkOptions& options) {
  try {
    WalkIn(scenery, options);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

class WalkTest : public testing::Test {
 protected:
  const Scenery rooms_ = TwoRooms();
  const WalkOptions options_{.seed = 3, .length = 80, .starts = {Vector3f(-2, 4.5F, 0)}};
};

TEST_F(WalkTest, GoesThroughTheDoorAndUpTheStairsAtItsHeight) {
  const Walk walk = WalkIn(rooms_, options_);
  int below = 0;
  int above = 0;
  int passages = 0;
  int straight = 0;
  for (size_t i = 0; i < walk.positions.size(); ++i) {
    const Eigen::Vector3d& p = walk.positions[i];
    if (p.x() < -0.9) {
      EXPECT_NEAR(p.z(), options_.size.camera_height, 1e-3);
      ++below;
    } else if (p.x() > 2.8) {
      EXPECT_NEAR(p.z(), kUpper + options_.size.camera_height, 1e-3);
      ++above;
    }
    if (i == 0) continue;
    const Eigen::Vector3d step = p - walk.positions[i - 1];
    EXPECT_LT(std::abs(step.z()), 0.11);  // the stairs become a slope of 0.2 to 0.3 m
    EXPECT_LT(step.head<2>().norm(), walk.spacing + 1e-6);
    straight += step.head<2>().norm() > 0.95 * walk.spacing ? 1 : 0;
    if ((p.x() > 0.1) != (walk.positions[i - 1].x() > 0.1)) {
      ++passages;
      EXPECT_GT(p.y(), kDoorLow + 0.28);
      EXPECT_LT(p.y(), kDoorHigh - 0.28);
    }
  }
  EXPECT_GT(below, 50);
  EXPECT_GT(above, 50);
  EXPECT_GE(passages, 1);
  EXPECT_GT(straight, 0.9 * static_cast<double>(walk.positions.size()));
}

TEST_F(WalkTest, HasTheLengthAndTheClearance) {
  const Walk walk = WalkIn(rooms_, options_);
  EXPECT_NEAR(static_cast<double>(walk.positions.size() - 1) * walk.spacing, options_.length, 0.2);
  for (const Eigen::Vector3d& p : walk.positions) {
    EXPECT_GT(p.x(), -5.71);
    EXPECT_LT(p.x(), 7.71);
    EXPECT_GT(p.y(), 0.29);
    EXPECT_LT(p.y(), 5.71);
    EXPECT_FALSE(IsOnPlatform(p)) << p.transpose();
  }
  std::vector<double> times;
  for (size_t i = 0; i < walk.positions.size(); ++i)
    times.push_back(static_cast<double>(i) * walk.spacing);
  const CameraPath path(LookAhead(times, walk.positions));
  RequireFreePath(RayScene(rooms_), path, path.end());
}

TEST_F(WalkTest, IsTheSameForEqualSeedsOnly) {
  const Walk walk = WalkIn(rooms_, options_);
  EXPECT_EQ(walk.positions, WalkIn(rooms_, options_).positions);
  WalkOptions other = options_;
  other.seed = 4;
  EXPECT_NE(walk.positions, WalkIn(rooms_, other).positions);
}

TEST_F(WalkTest, StaysOnAnIslandIfItStartsThere) {
  WalkOptions options = options_;
  options.starts = {Vector3f(-4, 2, 0.6F)};
  options.length = 20;
  for (const Eigen::Vector3d& p : WalkIn(rooms_, options).positions) {
    EXPECT_TRUE(IsOnPlatform(p));
    EXPECT_NEAR(p.z(), 0.6 + options.size.camera_height, 1e-3);
  }
}

TEST_F(WalkTest, DoesNotClimbHighStepsNorPassLowDoors) {
  WalkOptions options = options_;
  options.size.step = 0.15;
  for (const Eigen::Vector3d& p : WalkIn(rooms_, options).positions) EXPECT_LT(p.x(), 0.45);
  options = options_;
  options.size.camera_height = 2.1;  // the door is 2.3 m high
  for (const Eigen::Vector3d& p : WalkIn(rooms_, options).positions) EXPECT_LT(p.x(), 0);
}

TEST_F(WalkTest, RefusesScenesInWhichNobodyCanWalk) {
  WalkOptions options = options_;
  options.starts = {Vector3f(-2, 4.5F, 30)};
  EXPECT_THAT(Problem(rooms_, options), HasSubstr("nobody can walk from the start"));
  options = options_;
  options.is_floor = {false};  // all is water
  EXPECT_THAT(Problem(rooms_, options), HasSubstr("nobody can walk"));
  Scenery wall;
  wall.palette = PlainMaterials();
  AddRectangle({0, 0, 0}, {0, 5, 5}, &wall.fixed);
  wall.fixed.PartitionCutouts(wall.palette);
  options = {};
  EXPECT_THAT(Problem(wall, options), HasSubstr("nobody can walk here"));
  Scenery plain;
  plain.palette = PlainMaterials();
  AddRectangle({0, 0, 0}, {90000, 90000, 0}, &plain.fixed);
  plain.fixed.PartitionCutouts(plain.palette);
  EXPECT_THAT(Problem(plain, options), HasSubstr("too large"));
}

TEST(WalkableGrid, HasNoPlacesOnOrUnderWater) {
  Scenery scenery;
  scenery.palette = PlainMaterials();
  AddRectangle({0, 0, 0}, {4, 4, 0}, &scenery.fixed);
  AddRectangle({0, 0, 3}, {2, 4, 3}, &scenery.fixed, 1);  // water over a half
  scenery.fixed.PartitionCutouts(scenery.palette);
  const WalkableGrid grid(RayScene(scenery), {Vector3f(-0.5F, -0.5F, -1), Vector3f(4.5F, 4.5F, 6)},
                          {true, false}, {});
  EXPECT_EQ(grid.Find({1, 2, 0}, 0.3F), kNoPlace);
  EXPECT_EQ(grid.Find({1, 2, 3}, 0.3F), kNoPlace);
  EXPECT_NE(grid.Find({3, 2, 0}, 0.3F), kNoPlace);
}

TEST(WalkableGrid, FindsFloorsAboveEachOther) {
  Scenery scenery;
  scenery.palette = PlainMaterials();
  for (const float z : {0.F, 3.F, 4.5F}) AddRectangle({0, 0, z}, {4, 4, z}, &scenery.fixed);
  scenery.fixed.PartitionCutouts(scenery.palette);
  const WalkableGrid grid(RayScene(scenery), {Vector3f(-0.5F, -0.5F, -1), Vector3f(4.5F, 4.5F, 6)},
                          {}, {});
  // The storey between 3 and 4.5 m is too low.
  EXPECT_NE(grid.Find({2, 2, 0.1F}, 0.3F), kNoPlace);
  EXPECT_EQ(grid.Find({2, 2, 3.1F}, 0.3F), kNoPlace);
  EXPECT_NE(grid.Find({2, 2, 4.6F}, 0.3F), kNoPlace);
  const std::vector<uint32_t> components = grid.Components();
  EXPECT_EQ(*std::max_element(components.begin(), components.end()), 1U);
  // The border of the floor is a drop: clearance grows inward up to its limit.
  EXPECT_LT(grid.places()[grid.Find({0.05F, 2, 0}, 0.3F)].clearance, 0.2F);
  EXPECT_EQ(grid.places()[grid.Find({2, 2, 0}, 0.3F)].clearance, kFarClearance);
}

}  // namespace
}  // namespace orb360::town
