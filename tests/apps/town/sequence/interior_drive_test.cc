#include "apps/town/sequence/interior_drive.h"

#include <gtest/gtest.h>
#include <omp.h>

#include "apps/town/import/camera_path.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

Recording SmallRecording() { return {EquirectangularCamera(256, 128), 20, 40}; }

InteriorSpec InteriorOf(uint64_t seed) {
  InteriorSpec spec;
  spec.seed = seed;
  return spec;
}

bool SameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// Returns a seed of each kind of building.
std::vector<uint64_t> SeedsOfAllKinds() {
  std::vector<uint64_t> seeds;
  for (int kind = 0; kind < kBuildingKinds; ++kind) {
    uint64_t seed = 1;
    while (KindOfInterior(seed) != static_cast<BuildingKind>(kind)) ++seed;
    seeds.push_back(seed);
  }
  return seeds;
}

TEST(InteriorDriveSlow, GivesTheSameBytesForAnyNumberOfThreads) {
  const InteriorSpec spec = InteriorOf(7);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const InteriorDrive one(spec, SmallRecording());
  const cv::Mat3b colour = one.Colour(one.SceneAt(20), 20);
  const cv::Mat1f range = one.Geometry(one.SceneAt(20), 20).range;
  omp_set_num_threads(2);
  const InteriorDrive two(spec, SmallRecording());
  EXPECT_TRUE(SameBytes(colour, two.Colour(two.SceneAt(20), 20)));
  EXPECT_TRUE(SameBytes(range, two.Geometry(two.SceneAt(20), 20).range));
  omp_set_num_threads(threads);
}

TEST(InteriorDriveSlow, IsWellExposedAndLevelAndFreeInAllKinds) {
  for (const uint64_t seed : SeedsOfAllKinds()) {
    const InteriorDrive drive(InteriorOf(seed), {EquirectangularCamera(128, 64), 1, 60});
    double mean = 0;
    double saturated = 0;
    std::vector<StampedPose> poses;
    std::vector<Rigid3> places;
    for (int frame = 0; frame < 60; ++frame) {
      poses.push_back({static_cast<double>(frame), drive.WorldFromCamera(frame)});
      places.push_back(drive.WorldFromCamera(frame));
      if (frame % 5 != 0) continue;
      const cv::Mat3b image = drive.Colour(drive.SceneAt(frame), frame);
      cv::Mat grey;
      cv::transform(image, grey, cv::Matx13f(0.1F, 0.6F, 0.3F));
      mean += cv::mean(grey)[0] / 12;
      saturated += cv::countNonZero(grey > 250) / (12.0 * 128 * 64);
    }
    EXPECT_GT(mean, 60) << seed;
    EXPECT_LT(mean, 190) << seed;
    EXPECT_LT(saturated, 0.08) << seed;
    ASSERT_TRUE(drive.camera_height().has_value());
    EXPECT_NEAR(HeightAboveGround(drive.scene(), places).value_or(0), *drive.camera_height(), 0.05)
        << seed;
    std::vector<StampedPose> dense;
    for (double time = 0; time < 60; time += 0.1) {
      const WalkState state = drive.walk().At(time);
      dense.push_back({time,
                       {Eigen::Quaterniond::Identity(),
                        {state.position.x(), state.position.y(), *drive.camera_height()}}});
    }
    EXPECT_NO_THROW(RequireFreePath(drive.scene(), CameraPath(dense), 59.9)) << seed;
  }
}

TEST(InteriorDriveSlow, RefusesACameraThatDoesNotPassTheDoors) {
  InteriorSpec spec = InteriorOf(1);
  spec.mount.height = 3;
  EXPECT_THROW(InteriorDrive(spec, SmallRecording()), UserError);
  spec.mount.height = 0.5;
  EXPECT_EQ(InteriorDrive(spec, SmallRecording()).camera_height(), 0.5);
}

}  // namespace
}  // namespace orb360::town
