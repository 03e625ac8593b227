#include "slam/pipeline/moving_object_pass.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/depth/driving_scene.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);

class CorrectMovingObjectsTest : public testing::Test {
 protected:
  CorrectMovingObjectsTest() {
    for (int i = 0; i < 9; ++i) {
      const double x = 2.0 * (i - 4);
      views_.push_back(
          {.frame_index = 10 * i, .world_from_camera = scene_.CameraAt(x), .neighbours = {}});
      if (i != 7) store_.Put(10 * i, scene_.Render(kCamera, x));
    }
  }

  int Correct(const ViewProgress& progress = {},
              const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ()) {
    const auto all_others = [this](size_t view) {
      std::vector<size_t> others;
      for (size_t i = 0; i < views_.size(); ++i) {
        if (i != view) others.push_back(i);
      }
      return others;
    };
    return CorrectMovingObjects(views_, all_others, up, {}, store_, progress);
  }

  // The range of the middle of the car in the view at the origin.
  float RangeOfCar() const {
    const auto pixel = kCamera.Project(Eigen::Vector3d(0, 4, -0.5));
    return store_.Get(40).range.at<float>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()));
  }

  TempFolder folder_;
  DepthMapStore store_{folder_ / "depth"};
  DrivingScene scene_{.box = MovingBox{{-2, 4, -DrivingScene::kHeight}, {4.5, 1.8, 1.5}, 0.75}};
  std::vector<DenseView> views_;
};

TEST_F(CorrectMovingObjectsTest, CorrectsTheStoredDepthOfViewsThatShowOne) {
  EXPECT_GT(RangeOfCar(), 15);
  EXPECT_GT(Correct(), 4);
  EXPECT_NEAR(RangeOfCar(), 4, 0.5);
  EXPECT_FALSE(store_.Contains(70));
}

TEST_F(CorrectMovingObjectsTest, LeavesDepthWithoutGround) {
  EXPECT_EQ(Correct({}, Eigen::Vector3d::UnitX()), 0);
  EXPECT_GT(RangeOfCar(), 15);
}

TEST_F(CorrectMovingObjectsTest, EndsWhenItIsInterrupted) {
  EXPECT_EQ(Correct([](int, int) { return false; }), 0);
  EXPECT_GT(RangeOfCar(), 15);
}

}  // namespace
}  // namespace orb360
