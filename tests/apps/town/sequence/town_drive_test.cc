#include "apps/town/sequence/town_drive.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <omp.h>
#include <unistd.h>

#include "apps/town/sequence/render_folder.h"
#include "slam/io/dataset.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

TownSpec SmallTown() {
  TownSpec spec = FindTown("11");
  spec.plan = {.columns = 2, .rows = 2, .spacing = 55, .tour_blocks = 1};
  spec.traffic = 1;
  return spec;
}

/// Built once: it takes seconds.
const Drive& SmallDrive() {
  static const TownDrive drive(SmallTown(), {EquirectangularCamera(512, 256), 20, 4});
  return drive;
}

bool SameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// The bytes of every file below a folder, in the order of their names.
std::string Contents(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::ostringstream all;
  for (const auto& path : paths)
    all << path.lexically_relative(folder) << std::ifstream(path, std::ios::binary).rdbuf();
  return all.str();
}

class DriveSlow : public testing::Test {
 protected:
  DriveSlow()
      : folder_(std::filesystem::temp_directory_path() /
                ("town_test_" + std::to_string(getpid()))) {}
  ~DriveSlow() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

TEST_F(DriveSlow, GivesTheSameBytesForAnyNumberOfThreadsAndFromASecondBuild) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const TownDrive again(SmallTown(), {EquirectangularCamera(512, 256), 20, 4});
  const FrameScene scene_one = again.SceneAt(30);
  const cv::Mat3b colour_one = again.Colour(scene_one, 30);
  const GeometryImage geometry_one = again.Geometry(scene_one, 30);
  omp_set_num_threads(2);
  const FrameScene scene = SmallDrive().SceneAt(30);
  EXPECT_TRUE(SameBytes(colour_one, SmallDrive().Colour(scene, 30)));
  EXPECT_TRUE(SameBytes(geometry_one.range, SmallDrive().Geometry(scene, 30).range));
  EXPECT_TRUE(SameBytes(geometry_one.object, SmallDrive().Geometry(scene, 30).object));
  omp_set_num_threads(threads);
}

TEST_F(DriveSlow, AdaptiveSamplesAreAsGoodAsAllSamples) {
  Recording recording{EquirectangularCamera(512, 256), 20, 4};
  recording.sampling = Sampling::kFull;
  const TownDrive full(SmallTown(), recording);
  const FrameScene scene = SmallDrive().SceneAt(30);
  EXPECT_GT(cv::PSNR(SmallDrive().Colour(scene, 30), full.Colour(scene, 30)), 42);
}

TEST_F(DriveSlow, SensorEffectsOfAFrameDependOnNothingRenderedBefore) {
  Recording recording{EquirectangularCamera(256, 128), 20, 4};
  recording.sensor.auto_exposure = AutoExposure();
  recording.sensor.motion_blur = MotionBlur();
  recording.sensor.dual_lens = DualLens();
  recording.sensor.noise = SensorNoise();
  recording.sensor.jpeg_quality = 80;
  recording.cube_size = 96;
  const TownDrive drive(SmallTown(), recording);
  const cv::Mat3b alone = drive.Colour(drive.SceneAt(2), 2);
  const cv::Mat3b first = drive.Colour(drive.SceneAt(0), 0);  // the shutter opens before time 0
  EXPECT_FALSE(SameBytes(alone, first));
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  EXPECT_TRUE(SameBytes(alone, drive.Colour(drive.SceneAt(2), 2)));
  omp_set_num_threads(threads);
}

TEST_F(DriveSlow, PoseAndRangeAgreeBetweenFrames) {
  // A point seen in one frame and carried into another by the poses must be met there at its
  // distance, unless something stands in front of it.
  const Drive& drive = SmallDrive();
  const EquirectangularCamera camera(2048, 1024);  // distant lamp posts must be as wide as a pixel
  const FrameScene scene_a = drive.SceneAt(40);
  const FrameScene scene_b = drive.SceneAt(52);
  const GeometryImage a = RenderGeometry(scene_a, camera, drive.WorldFromCamera(40));
  const GeometryImage b = RenderGeometry(scene_b, camera, drive.WorldFromCamera(52));
  const Rigid3 b_from_a = drive.WorldFromCamera(52).Inverse() * drive.WorldFromCamera(40);
  ASSERT_GT(b_from_a.translation.norm(), 1.0);
  int unoccluded = 0;
  int found = 0;
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const uint16_t object = a.object(row, column);
      if (object == FrameScene::kNothing || object >= scene_a.first_moving_id()) continue;
      const Eigen::Vector3d point =
          b_from_a * camera.BackProject({column + 0.5, row + 0.5}, a.range(row, column));
      const Eigen::Vector2d pixel = camera.Project(point);
      const double range = point.norm();
      // The pixels around: the nearest surface there, and whether the point's own object is met
      // about as far away as the point is (a pixel's slant allowed for).
      float nearest = 1e30F;
      float farthest = 0;
      bool has_object = false;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int y = std::clamp(static_cast<int>(pixel.y()) + dy, 0, camera.height() - 1);
          const int x = (static_cast<int>(pixel.x()) + dx + camera.width()) % camera.width();
          const float met = b.range(y, x) > 0 ? b.range(y, x) : 1e6F;
          nearest = std::min(nearest, met);
          farthest = std::max(farthest, met);
          has_object |= b.object(y, x) == object;
        }
      }
      if (nearest < 0.995 * range - 0.02) continue;
      ++unoccluded;
      if (has_object && farthest > 0.995 * range - 0.02) ++found;
    }
  }
  EXPECT_GT(unoccluded, 50000);
  EXPECT_GE(found, 0.999 * unoccluded) << found << " of " << unoccluded;
}

TEST_F(DriveSlow, TrafficMovesAndNothingElseDoes) {
  const Drive& drive = SmallDrive();
  const FrameScene scene = drive.SceneAt(60);
  const FrameScene later = drive.SceneAt(70);
  const GeometryImage before = drive.Geometry(scene, 60);
  const GeometryImage after = drive.Geometry(later, 60);  // the same pose, other traffic
  int moving = 0;
  for (int row = 0; row < before.range.rows; ++row) {
    for (int column = 0; column < before.range.cols; ++column) {
      const bool is_moving = std::max(before.object(row, column), after.object(row, column)) >=
                             scene.first_moving_id();
      moving += is_moving ? 1 : 0;
      if (!is_moving) {
        ASSERT_EQ(before.range(row, column), after.range(row, column));
      }
    }
  }
  EXPECT_GT(moving, 100);
}

TEST_F(DriveSlow, AnInterruptedRenderingResumesToTheSameFolder) {
  const FolderOptions options{.depth_every = 2, .exr = true, .masks = true};
  const auto silent = [](int, int) {};
  const std::filesystem::path whole = folder_ / "whole";
  const std::filesystem::path resumed = folder_ / "resumed";
  RenderIntoFolder(SmallDrive(), whole, options, silent);
  struct Interrupted {};
  EXPECT_THROW(RenderIntoFolder(SmallDrive(), resumed, options,
                                [](int done, int) {
                                  if (done == 2) throw Interrupted();
                                }),
               Interrupted);
  EXPECT_FALSE(std::filesystem::exists(resumed / "rgb/000003.jpg"));
  int rendered_now = 0;
  RenderIntoFolder(SmallDrive(), resumed, options,
                   [&](int, int rendered) { rendered_now = rendered; });
  EXPECT_EQ(rendered_now, 2);
  EXPECT_EQ(Contents(whole), Contents(resumed));
  EXPECT_TRUE(std::filesystem::exists(whole / "depth/000002.png"));
  EXPECT_TRUE(std::filesystem::exists(whole / "range/000002.exr"));
  EXPECT_FALSE(std::filesystem::exists(whole / "depth/000001.png"));
  const Dataset dataset = OpenDataset(whole);
  EXPECT_EQ(dataset.frame_rate, 20);
  EXPECT_NEAR(dataset.camera_height.value(), SmallDrive().camera_height().value(), 1e-4);
}

TEST_F(DriveSlow, AFolderWithAnotherSequenceIsRefused) {
  const auto render = [&](int frames) {
    const TownDrive drive(SmallTown(), {EquirectangularCamera(64, 32), 20, frames});
    RenderIntoFolder(drive, folder_, {}, [](int, int) {});
  };
  render(1);
  EXPECT_THROW(render(2), UserError);
}

}  // namespace
}  // namespace orb360::town
