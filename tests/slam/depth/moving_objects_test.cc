#include "slam/depth/moving_objects.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/depth/driving_scene.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(512, 256);

// The number of objects that are found from the origin, and the depth after that.
struct Result {
  int num_objects;
  DenseDepth before;
  DenseDepth after;
};

Result PlaceFrom(const DrivingScene& scene, const std::vector<double>& others_at = {-9, -6, 6, 9}) {
  std::vector<DepthView> views;
  views.reserve(others_at.size());
  std::vector<const DepthView*> others;
  for (const double x : others_at) {
    views.emplace_back(scene.Render(kCamera, x), scene.CameraAt(x), 0.01);
    others.push_back(&views.back());
  }
  Result result{0, scene.Render(kCamera, 0), scene.Render(kCamera, 0)};
  const DepthView view(result.before, scene.CameraAt(0), 0.01);
  const DenseGround ground{Eigen::Vector3d::UnitZ(), std::log(DrivingScene::kHeight), 0.01};
  const MovingObjectOptions options;
  const std::vector<MovingObject> objects =
      FindMovingObjects(FindBelowGround(view, ground, options), view, ground, others, options);
  PlaceOnGround(objects, ground, options, &result.after);
  const cv::Mat mask = MaskOf(objects, result.after.range.size());
  EXPECT_EQ(cv::countNonZero((result.before.range != result.after.range) & ~mask), 0);
  result.num_objects = static_cast<int>(objects.size());
  return result;
}

// A car as high as the camera, at the given place.
DrivingScene CarAt(double x, double y, double speed) {
  return {.box = MovingBox{{x, y, -DrivingScene::kHeight}, {4.5, 1.8, 1.5}, speed}};
}

// The fraction of the pixels of the box whose ranges are within 15 % of the truth.
double FractionRight(const DrivingScene& scene, const DenseDepth& depth) {
  double right = 0;
  double all = 0;
  for (int row = 0; row < depth.range.rows; ++row) {
    for (int column = 0; column < depth.range.cols; ++column) {
      const double truth = scene.RangeOfBox(0, kCamera.Bearing({column + 0.5, row + 0.5}));
      if (!(truth > 0)) continue;
      ++all;
      right += std::abs(depth.range.at<float>(row, column) / truth - 1) < 0.15;
    }
  }
  return right / all;
}

bool IsUnchanged(const Result& result) {
  return cv::countNonZero(result.before.range != result.after.range) == 0 &&
         cv::countNonZero(result.before.confidence != result.after.confidence) == 0;
}

TEST(FindMovingObjects, PutsACarThatMovesAlongWhereItTouchesTheGround) {
  const DrivingScene scene = CarAt(-2, 4, 0.75);
  const Result result = PlaceFrom(scene);
  EXPECT_EQ(result.num_objects, 1);
  EXPECT_EQ(FractionRight(scene, result.before), 0);
  EXPECT_GT(FractionRight(scene, result.after), 0.9);
  // Nothing else changes, and what changes is stated to be uncertain.
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const float before = result.before.range.at<float>(row, column);
      const float after = result.after.range.at<float>(row, column);
      if (before == after) continue;
      EXPECT_GT(scene.RangeOfBox(0, kCamera.Bearing({column + 0.5, row + 0.5})), 0);
      EXPECT_NEAR(result.after.confidence.at<float>(row, column),
                  1 / (1 + MovingObjectOptions().stated_error), 1e-6);
      EXPECT_EQ(result.after.source.at<std::uint8_t>(row, column),
                static_cast<std::uint8_t>(RangeSource::kMovingObject));
    }
  }
}

TEST(FindMovingObjects, AnObjectMayLieAcrossTheEdgeOfTheImage) {
  // The edge of the image is behind the camera, which looks along -x.
  const DrivingScene scene{.box = MovingBox{{5, -1, -DrivingScene::kHeight}, {4, 2, 1.5}, 0.8}};
  const Result result = PlaceFrom(scene);
  EXPECT_EQ(result.num_objects, 1);
  EXPECT_GT(FractionRight(scene, result.after), 0.9);
}

TEST(FindMovingObjects, LeavesTheLandBesideARoadThatFallsAway) {
  for (const double fall : {0.8, 3.0}) {
    const Result result = PlaceFrom({.edge = 4.0, .fall = fall});
    EXPECT_EQ(result.num_objects, 0);
    EXPECT_TRUE(IsUnchanged(result)) << fall;
  }
}

TEST(FindMovingObjects, LeavesAPitThatOtherViewsSeeFromLowerPlaces) {
  // Their rays hardly fall, so that what they see through the plane is hardly below it.
  const Result result =
      PlaceFrom({.edge = 4.0, .fall = 3.0, .wall = 20.0, .height_elsewhere = 0.2});
  EXPECT_EQ(result.num_objects, 0);
  EXPECT_TRUE(IsUnchanged(result));
}

TEST(FindMovingObjects, GroundThatIsALittleHigherIsGroundAndALittleLowerIsNone) {
  // By a seventh of the range.
  DrivingScene scene = CarAt(-2, 4, 0.75);
  scene.bump = 0.2;
  EXPECT_EQ(PlaceFrom(scene).num_objects, 1);
  scene.bump = -0.2;
  EXPECT_TRUE(IsUnchanged(PlaceFrom(scene)));
}

TEST(FindMovingObjects, LeavesWhatNoOtherViewTellsToBeGround) {
  const DrivingScene scene = CarAt(-2, 4, 0.75);
  EXPECT_TRUE(IsUnchanged(PlaceFrom(scene, {})));
  // From here the car hides the same ground.
  EXPECT_TRUE(IsUnchanged(PlaceFrom(scene, {-0.1, 0.1})));
}

TEST(FindMovingObjects, LeavesObjectsAtRestAndSlowOnes) {
  for (const double speed : {0.0, 0.2}) {
    EXPECT_TRUE(IsUnchanged(PlaceFrom(CarAt(-2, 4, speed)))) << speed;
  }
}

TEST(FindMovingObjects, LeavesAViewWithoutGroundAroundIt) {
  DrivingScene scene;
  scene.edge = -1e9;
  scene.fall = 2.0;
  EXPECT_TRUE(IsUnchanged(PlaceFrom(scene)));
}

}  // namespace
}  // namespace orb360
