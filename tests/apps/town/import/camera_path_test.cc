#include "apps/town/import/camera_path.h"

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/apps/town/plain_materials.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using ::testing::HasSubstr;

class CameraPathTest : public testing::Test {
 protected:
  ~CameraPathTest() override { std::filesystem::remove(path_); }
  CameraPath Read(const std::string& text) const {
    std::ofstream(path_) << text;
    return ReadCameraPath(path_);
  }
  std::string Problem(const std::string& text) const {
    try {
      Read(text);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("path_test_" + std::to_string(getpid()) + ".txt");
};

TEST_F(CameraPathTest, GoesThroughItsPlacesAtUnchangedSpeedOnAStraightLine) {
  const CameraPath path = Read("# time x y z\n0 0 0 2\n1 3 0 2\n\n2 6 0 2 # a comment\n4 12 0 2\n");
  EXPECT_EQ(path.end(), 4);
  for (double t = 0; t <= 4; t += 0.1) {
    EXPECT_TRUE(path.At(t).translation.isApprox(Eigen::Vector3d(3 * t, 0, 2), 1e-9)) << t;
    // Level, and the camera's -x along the way.
    EXPECT_TRUE(
        (path.At(t).rotation * -Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitX(), 1e-9));
    EXPECT_TRUE(
        (path.At(t).rotation * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  }
  EXPECT_TRUE(path.At(99).translation.isApprox(Eigen::Vector3d(12, 0, 2)));
}

TEST_F(CameraPathTest, FollowsACircleGivenByFewPlaces) {
  std::vector<StampedPose> knots;
  constexpr double kStep = std::numbers::pi / 8;
  for (int i = 0; i <= 16; ++i) {
    const double angle = kStep * i;
    knots.push_back({angle,
                     {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
                      {10 * std::cos(angle), 10 * std::sin(angle), 0}}});
  }
  const CameraPath path(knots);
  for (double t = kStep; t < 15 * kStep; t += 0.01) {
    const Rigid3 pose = path.At(t);
    EXPECT_NEAR(pose.translation.norm(), 10, 0.05);
    EXPECT_NEAR(pose.rotation.angularDistance(
                    Eigen::Quaterniond(Eigen::AngleAxisd(t, Eigen::Vector3d::UnitZ()))),
                0, 1e-9);
  }
}

TEST_F(CameraPathTest, FollowsAThrownBallExactlyHoweverUnevenlyItIsGiven) {
  const auto ball = [](double t) { return Eigen::Vector3d(3 * t, 1 - t, 8 * t - 4.9 * t * t); };
  std::vector<StampedPose> knots;
  for (const double t : {0.0, 0.4, 0.5, 1.1, 1.2, 2.0, 2.3})
    knots.push_back({t, {Eigen::Quaterniond::Identity(), ball(t)}});
  const CameraPath path(knots);
  for (double t = 0.4; t < 2.0; t += 0.01)
    EXPECT_TRUE(path.At(t).translation.isApprox(ball(t), 1e-9)) << t;
}

TEST_F(CameraPathTest, LooksWhereItWillGoBeforeItStarts) {
  const CameraPath path = Read("0 0 0 2\n1 0 0 2\n2 0 0 2\n3 0 5 2\n4 0 5 2\n5 0 5 2\n");
  for (double t = 0; t <= 5; t += 0.1) {
    EXPECT_TRUE(
        (path.At(t).rotation * -Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-9))
        << t;
  }
}

TEST_F(CameraPathTest, ReadsPosesWithRotationsAsTrajectoriesAreWritten) {
  const CameraPath path = Read("0 1 2 3 0 0 0 1\n1 1 2 4 0 0 0 1\n");
  // An optical camera in the world's axes looks along +z: -x of ours.
  EXPECT_TRUE(
      (path.At(0.5).rotation * -Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(path.At(0.5).translation.isApprox(Eigen::Vector3d(1, 2, 3.5)));
}

TEST_F(CameraPathTest, RefusesWhatIsNoPathWithFileAndLine) {
  EXPECT_THAT(Problem("0 0 0 2\n1 3 zero 2\n"), HasSubstr("line 2: expected four numbers"));
  EXPECT_THAT(Problem("0 0 0 2\n1 3 0 2 5\n"), HasSubstr("line 2: expected four numbers"));
  EXPECT_THAT(Problem("1 0 0 2\n1 3 0 2\n"), HasSubstr("line 2: times must increase"));
  EXPECT_THAT(Problem("0 0 0 2\n"), HasSubstr("at least two places"));
  EXPECT_THROW(ReadCameraPath("/nowhere/path.txt"), UserError);
}

/// A floor at height 0 and a wall across x = 5.
class FloorAndWall {
 public:
  FloorAndWall() {
    MeshBuilder builder(materials_);
    builder.AddGroundPolygon(0, {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}});
    builder.AddFace(0, {5, -1, 0}, {5, 1, 0}, {5, 1, 3}, {5, -1, 3});
    scenery_.palette = materials_;
    scenery_.fixed = builder.mesh();
    scenery_.fixed.PartitionCutouts(materials_);
  }
  RayScene Scene() const { return RayScene(scenery_); }

 private:
  Materials materials_ = PlainMaterials();
  Scenery scenery_;
};

std::vector<Rigid3> Walk(double y) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < 100; ++i)
    poses.push_back({Eigen::Quaterniond::Identity(), {0.1 * i, y, 1.7}});
  return poses;
}

CameraPath Timed(const std::vector<Rigid3>& poses, double step) {
  std::vector<StampedPose> knots;
  for (size_t i = 0; i < poses.size(); ++i)
    knots.push_back({step * static_cast<double>(i), poses[i]});
  return CameraPath(knots);
}

TEST(RequireFreePath, StopsAtAWallAndSaysWhenAndWhere) {
  const FloorAndWall world;
  const RayScene scene = world.Scene();
  EXPECT_NO_THROW(RequireFreePath(scene, Timed(Walk(3), 0.1), 9.9));
  const CameraPath through = Timed(Walk(0.5), 0.1);  // at the wall after five seconds
  EXPECT_NO_THROW(RequireFreePath(scene, through, 4.9));
  try {
    RequireFreePath(scene, through, 9.9);
    FAIL() << "went through the wall";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("through a surface at time 4.9"));
    EXPECT_THAT(error.what(), HasSubstr("0.5, 1.7)"));
  }
}

TEST(HeightAboveGround, IsFoundWhereItIsTheSameAllAlong) {
  const FloorAndWall world;
  const RayScene scene = world.Scene();
  EXPECT_NEAR(HeightAboveGround(scene, Walk(3)).value(), 1.7, 1e-5);
  std::vector<Rigid3> climbing = Walk(3);
  for (size_t i = 0; i < climbing.size(); ++i)
    climbing[i].translation.z() += 0.02 * static_cast<double>(i);
  EXPECT_FALSE(HeightAboveGround(scene, climbing).has_value());
}

}  // namespace
}  // namespace orb360::town
