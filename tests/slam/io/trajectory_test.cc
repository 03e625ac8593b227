#include <clocale>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/trajectory_journal.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Directions in the paper's camera frame.
const Eigen::Vector3d kForward = -Eigen::Vector3d::UnitX();
const Eigen::Vector3d kRight = Eigen::Vector3d::UnitY();
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

Rigid3 RandomPose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  return {ExpSo3(vector()), 10.0 * vector()};
}

void ExpectNear(const Rigid3& a, const Rigid3& b, double tolerance) {
  EXPECT_LT((a.translation - b.translation).norm(), tolerance);
  EXPECT_LT(a.rotation.angularDistance(b.rotation), tolerance);
}

TEST(Trajectory, AFileHoldsOpticalCamerasInAForwardLeftUpWorld) {
  // A camera that has moved 2 m forward and 1 m up from the first, and turned left by 90 degrees.
  const Rigid3 map_from_first;
  const Rigid3 map_from_second{ExpSo3(kUp * std::numbers::pi / 2), 2.0 * kForward + 1.0 * kUp};
  const Rigid3 world_from_map = FileWorldFromMap(map_from_first);
  const TempFolder folder;
  WriteTrajectory(folder / "t.txt", std::vector<StampedPose>{{0.5, map_from_second}},
                  world_from_map);
  // Looking along +y with z up: optical x = +x (right), optical y = -z (down), optical z = +y;
  // that is a turn of -90 degrees about x.
  std::istringstream text(ReadText(folder / "t.txt"));
  std::string header;
  std::getline(text, header);
  EXPECT_EQ(header, "# timestamp tx ty tz qx qy qz qw");
  const double half = std::sqrt(0.5);
  for (const double expected : {0.5, 2.0, 0.0, 1.0, -half, 0.0, 0.0, half}) {
    double value = NAN;
    text >> value;
    EXPECT_NEAR(value, expected, 1e-9);
  }
}

TEST(Trajectory, TheFirstCameraIsTheFilesWorld) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 map_from_camera = RandomPose(random);
    const Rigid3 world_from_camera = FileWorldFromMap(map_from_camera) * map_from_camera;
    EXPECT_LT(world_from_camera.translation.norm(), 1e-12);
    EXPECT_LT((world_from_camera.rotation * kForward - Eigen::Vector3d::UnitX()).norm(), 1e-12);
    EXPECT_LT((world_from_camera.rotation * -kRight - Eigen::Vector3d::UnitY()).norm(), 1e-12);
    EXPECT_LT((world_from_camera.rotation * kUp - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  }
}

TEST(Trajectory, AKnownGroundLevelsTheFilesWorld) {
  std::mt19937 random(2);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 map_from_camera = RandomPose(random);
    const Eigen::Vector3d up_in_map = RandomPose(random).translation;
    const Rigid3 world_from_map = FileWorldFromMap(map_from_camera, up_in_map);
    EXPECT_LT((world_from_map.rotation * up_in_map.normalized() - kUp).norm(), 1e-12);
    EXPECT_LT((world_from_map * map_from_camera.translation).norm(), 1e-12);
    const Eigen::Vector3d heading = world_from_map.rotation * (map_from_camera.rotation * kForward);
    EXPECT_NEAR(heading.y(), 0.0, 1e-12);
    EXPECT_GT(heading.x(), 0.0);
    EXPECT_NEAR(world_from_map.rotation.norm(), 1.0, 1e-12);
  }
}

TEST(Trajectory, ACameraThatLooksStraightUpStillHasAHeading) {
  const Rigid3 world_from_map = FileWorldFromMap(Rigid3{}, kForward);
  EXPECT_LT((world_from_map.rotation * kForward - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((world_from_map.rotation * -kRight - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(Trajectory, ReadsBackWhatWasWritten) {
  std::mt19937 random(3);
  std::vector<StampedPose> poses;
  for (int i = 0; i < 50; ++i) poses.push_back({i / 29.97 + 12345.0, RandomPose(random)});
  const TempFolder folder;
  WriteTrajectory(folder / "t.txt", poses);
  const std::vector<StampedPose> read = ReadTrajectory(folder / "t.txt");
  ASSERT_EQ(read.size(), poses.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(read[i].timestamp, poses[i].timestamp, 1e-9);
    ExpectNear(read[i].world_from_camera, poses[i].world_from_camera, 3e-7);
  }
}

TEST(Trajectory, NumbersDoNotDependOnTheLocale) {
  const std::string before = setlocale(LC_ALL, nullptr);
  // Any locale with a decimal comma that the machine has; without one the test says little.
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) setlocale(LC_ALL, name);
  const TempFolder folder;
  WriteTrajectory(folder / "t.txt", std::vector<StampedPose>{{0.5, {{1, 0, 0, 0}, {0.25, 0, 0}}}});
  EXPECT_THAT(ReadText(folder / "t.txt"), HasSubstr("0.500000000 0.25 0 0"));
  EXPECT_EQ(ReadTrajectory(folder / "t.txt")[0].world_from_camera.translation.x(), 0.25);
  setlocale(LC_ALL, before.c_str());
}

TEST(Trajectory, ReadsCommentsBlankLinesTabsAndCarriageReturns) {
  const TempFolder folder;
  WriteText(folder / "t.txt",
            "# comment\r\n\r\n1.5\t1 2 3  0 0 0 1\r\n  # another\n2.5 +1 -2e-1 3. 0 0 0 -1.001");
  const std::vector<StampedPose> poses = ReadTrajectory(folder / "t.txt");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].timestamp, 1.5);
  EXPECT_EQ(poses[1].world_from_camera.translation, Eigen::Vector3d(1.0, -0.2, 3.0));
  EXPECT_NEAR(poses[1].world_from_camera.rotation.norm(), 1.0, 1e-12);
}

TEST(Trajectory, ABadLineIsNamed) {
  const TempFolder folder;
  const auto error = [&](const std::string& line) {
    WriteText(folder / "t.txt", "# header\n0 0 0 0 0 0 0 1\n" + line + "\n");
    const std::string message = MessageOf<UserError>([&] { ReadTrajectory(folder / "t.txt"); });
    const std::string where = (folder / "t.txt").string() + ":3: ";
    EXPECT_THAT(message, StartsWith(where));
    return message.substr(std::min(where.size(), message.size()));
  };
  EXPECT_THAT(error("1 2 3"), HasSubstr("found 3 words"));
  EXPECT_THAT(error("1 2 3 4 5 6 7 8 9"), HasSubstr("found 9 words"));
  EXPECT_THAT(error("1 x 3 0 0 0 0 1"), HasSubstr("`x` is not a number"));
  EXPECT_THAT(error("1 nan 3 0 0 0 0 1"), HasSubstr("`nan` is not a number"));
  EXPECT_THAT(error("1 1,5 3 0 0 0 0 1"), HasSubstr("`1,5` is not a number"));
  EXPECT_THAT(error("1 0 0 0 0 0 0 0.5"), HasSubstr("length is 0.5"));
  EXPECT_THAT(error("1 0 0 0 0 0 0 0"), HasSubstr("length is 0"));
}

TEST(Trajectory, AFileWithoutPosesOrNoFileIsNamed) {
  const TempFolder folder;
  WriteText(folder / "t.txt", "# only a comment\n");
  EXPECT_THAT(MessageOf<UserError>([&] { ReadTrajectory(folder / "t.txt"); }),
              HasSubstr("contains no pose"));
  EXPECT_THAT(MessageOf<UserError>([&] { ReadTrajectory(folder / "absent.txt"); }),
              HasSubstr("absent.txt: cannot be opened"));
  EXPECT_THAT(MessageOf<UserError>([&] { ReadTrajectory(folder.path()); }),
              HasSubstr("cannot be opened"));
}

TEST(TrajectoryJournal, HasEveryPoseAsSoonAsItIsAppended) {
  const TempFolder folder;
  TrajectoryJournal journal(folder / "j.txt");
  for (int i = 0; i < 5; ++i) {
    journal.Append({0.1 * i, {{1, 0, 0, 0}, {1.0 * i, 0, 0}}});
    const std::vector<StampedPose> poses = ReadTrajectory(folder / "j.txt");
    ASSERT_EQ(poses.size(), static_cast<size_t>(i + 1));
    EXPECT_EQ(poses.back().world_from_camera.translation.x(), i);
  }
}

}  // namespace
}  // namespace orb360
