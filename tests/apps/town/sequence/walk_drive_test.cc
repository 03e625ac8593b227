#include "apps/town/sequence/walk_drive.h"

#include <gtest/gtest.h>
#include <omp.h>

#include "apps/town/import/camera_path.h"
#include "apps/town/world/landscape/landscape.h"
#include "apps/town/world/tunnel/tunnel.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using World = WalkSpec::World;

WalkSpec SpecOf(World world, uint64_t seed) {
  WalkSpec spec;
  spec.world = world;
  spec.seed = seed;
  return spec;
}

/// Returns a wood, a cave and a tunnel with a lining. Other kinds differ in what is built only.
std::vector<WalkSpec> SomeKinds() {
  const auto seed_of = [](auto kind_of, auto kind) {
    uint64_t seed = 1;
    while (kind_of(seed) != kind) ++seed;
    return seed;
  };
  return {SpecOf(World::kLandscape, seed_of(KindOfLandscape, LandscapeKind::kConiferWood)),
          SpecOf(World::kTunnel, seed_of(KindOfTunnel, TunnelKind::kCave)),
          SpecOf(World::kTunnel, seed_of(KindOfTunnel, TunnelKind::kCulvert))};
}

TEST(WalkDriveSlow, IsWellExposedAndAboveTheGroundAndFree) {
  constexpr int kFrames = 590;
  for (const WalkSpec& spec : SomeKinds()) {
    const WalkDrive drive(spec, {EquirectangularCamera(128, 64), 10, kFrames});
    const std::string origin = drive.Origin();
    double mean = 0;
    double saturated = 0;
    std::vector<double> heights;
    for (int frame = 0; frame < kFrames; frame += 10) {
      const Vector3f at = drive.WorldFromCamera(frame).translation.cast<float>();
      heights.push_back(DistanceAlong(drive.scene(), at, -Vector3f::UnitZ(), 100));
      if (frame % 100 != 0) continue;
      const cv::Mat3b image = drive.Colour(drive.SceneAt(frame), frame);
      cv::Mat grey;
      cv::transform(image, grey, cv::Matx13f(0.1F, 0.6F, 0.3F));
      mean += cv::mean(grey)[0] / 6;
      saturated += cv::countNonZero(grey > 250) / (6.0 * 128 * 64);
    }
    EXPECT_GT(mean, 55) << origin;
    EXPECT_LT(mean, 190) << origin;
    EXPECT_LT(saturated, 0.1) << origin;
    for (const double height : heights) EXPECT_NEAR(height, *drive.camera_height(), 0.2) << origin;
    std::vector<StampedPose> path;
    for (int frame = 0; frame < kFrames; ++frame)
      path.push_back({frame / drive.fps(), drive.WorldFromCamera(frame)});
    EXPECT_NO_THROW(RequireFreePath(drive.scene(), CameraPath(path), path.back().timestamp))
        << origin;
  }
}

TEST(WalkDriveSlow, GivesTheSameBytesForAnyNumberOfThreads) {
  const Recording recording{EquirectangularCamera(128, 64), 20, 40};
  const int threads = omp_get_max_threads();
  WalkSpec spec = SpecOf(World::kTunnel, 7);
  spec.mount.height = 0.5;
  omp_set_num_threads(1);
  const WalkDrive one(spec, recording);
  EXPECT_EQ(one.camera_height(), 0.5);
  const cv::Mat3b colour = one.Colour(one.SceneAt(20), 20);
  omp_set_num_threads(2);
  const WalkDrive two(spec, recording);
  EXPECT_EQ(cv::norm(colour, two.Colour(two.SceneAt(20), 20), cv::NORM_INF), 0);
  omp_set_num_threads(threads);
}

TEST(WalkDriveSlow, RefusesACameraThatIsHigherThanThereIsRoom) {
  const Recording recording{EquirectangularCamera(64, 32), 20, 2};
  WalkSpec spec = SpecOf(World::kLandscape, 1);
  spec.mount.height = 9;
  EXPECT_THROW(WalkDrive(spec, recording), UserError);
}

TEST(WalkDrive, RefusesAnUnknownLight) {
  WalkSpec spec = SpecOf(World::kTunnel, 1);
  spec.light = "dawn";
  EXPECT_THROW(WalkDrive(spec, {EquirectangularCamera(64, 32), 20, 2}), UserError);
}

}  // namespace
}  // namespace orb360::town
