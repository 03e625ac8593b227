#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"
#include <orb360/slam/depth/sparse_depth.h>

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(1024, 512);

TEST(SparseDepth, GivesTheRangeAndPlaceOfEveryLandmark) {
  SyntheticScene scene(200);
  const Map map = scene.MakeMap(Walk(3, {-0.5, 0.2, 0.0}), 200, /*noise=*/0.0);
  const std::vector<SparsePoint> points = ProjectLandmarks(map, 1, kCamera, {});
  EXPECT_GT(points.size(), 190u);  // a few share a pixel
  const Rigid3 camera_from_world = map.keyframe(1).world_from_camera.Inverse();
  for (const SparsePoint& point : points) {
    const Eigen::Vector3d expected = camera_from_world * scene.points[point.landmark].position;
    EXPECT_NEAR(point.range, expected.norm(), 1e-9);
    EXPECT_LT((point.pixel - kCamera.Project(expected)).norm(), 1e-6);
  }
}

TEST(SparseDepth, TakesTheNearestOfTwoInOnePixel) {
  SyntheticScene scene(100);
  scene.points[1].position = 0.9 * scene.points[0].position;  // seen from the origin
  const Map map = scene.MakeMap({Rigid3(), {Eigen::Quaterniond::Identity(), {-0.5, 0, 0}}}, 100);
  const std::vector<SparsePoint> points = ProjectLandmarks(map, 0, kCamera, {});
  for (const SparsePoint& point : points) EXPECT_NE(point.landmark, 0);
  const SparseDepth images = RenderSparseDepth(points, kCamera);
  const Eigen::Vector2d pixel = kCamera.Project(scene.points[0].position);
  EXPECT_FLOAT_EQ(images.range.at<float>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x())),
                  static_cast<float>(scene.points[1].position.norm()));
  EXPECT_EQ(cv::countNonZero(images.range), static_cast<int>(points.size()));
  EXPECT_EQ(cv::countNonZero(images.confidence), static_cast<int>(points.size()));
}

TEST(SparseDepth, DropsWhatIsHiddenUnlessTheKeyframeSawItItself) {
  SyntheticScene scene(100);
  // Point 0 far behind point 1, a hundredth of a radian beside it.
  scene.points[1].position = Eigen::Vector3d(-3.0, 0.0, 0.0);
  scene.points[0].position = Eigen::Vector3d(-9.0, 0.09, 0.0);
  Map map = scene.MakeMap(Walk(3, {0.0, 0.4, 0.0}), 100, 0.0);
  const auto holds_hidden = [&] {
    for (const SparsePoint& point : ProjectLandmarks(map, 0, kCamera, {})) {
      if (point.landmark == 0) return true;
    }
    return false;
  };
  EXPECT_TRUE(holds_hidden());
  map.RemoveObservation(0, 0);
  EXPECT_FALSE(holds_hidden());
}

TEST(SparseDepth, DropsLandmarksThatAreOftenNotFound) {
  SyntheticScene scene(100);
  Map map = scene.MakeMap(Walk(3, {-0.5, 0.2, 0.0}), 100, 0.0);
  const auto holds = [&](LandmarkId id) {
    const auto points = ProjectLandmarks(map, 1, kCamera, {.min_found_fraction = 0.8});
    return std::ranges::count(points, id, &SparsePoint::landmark) == 1;
  };
  map.landmark(5).visible = 10;
  map.landmark(5).found = 9;
  EXPECT_TRUE(holds(5));
  map.landmark(5).found = 7;
  EXPECT_FALSE(holds(5));
}

TEST(SparseDepth, DropsWhatIsKnownTooBadly) {
  SyntheticScene scene(300);
  const Map map = scene.MakeMap(Walk(2, {-0.2, 0.1, 0.0}), 300);
  const SparseDepthOptions options;
  std::set<LandmarkId> taken;
  for (const SparsePoint& point : ProjectLandmarks(map, 1, kCamera, options)) {
    taken.insert(point.landmark);
    EXPECT_LE(RangeError(map, map.landmark(point.landmark)), options.half_confidence_error);
  }
  int dropped = 0;
  for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
    if (taken.contains(id) || !map.HasLandmark(id)) continue;
    dropped += RangeError(map, map.landmark(id)) > options.half_confidence_error;
  }
  EXPECT_GT(taken.size(), 20u);
  EXPECT_GT(dropped, 20);
}

TEST(SparseDepth, ErrorOfTheRangeIsWhatNoiseMakesOfIt) {
  // The same point measured again and again: the spread of the triangulated range over the range
  // must be what RangeError says, within a factor of two.
  constexpr int kTrials = 200;
  const Eigen::Vector3d point(-6.0, 1.0, 0.5);
  double sum = 0;
  double predicted = 0;
  RandomGeometry random(3);
  for (int trial = 0; trial < kTrials; ++trial) {
    SyntheticScene scene(1);
    scene.random = RandomGeometry(trial);
    scene.points[0].position = point;
    scene.points[0].max_range = point.norm();
    Map map = scene.MakeMap({Rigid3(), {Eigen::Quaterniond::Identity(), {0.0, 0.6, 0.0}}}, 1);
    // The measured range from the two noisy rays, in the plane of motion.
    const Eigen::Vector3d b1 = map.keyframe(0).features->bearings[0];
    const Eigen::Vector3d b2 = map.keyframe(1).features->bearings[0];
    const Eigen::Vector3d baseline(0.0, 0.6, 0.0);
    const double range = baseline.cross(b2).norm() / b1.cross(b2).norm();
    map.landmark(0).position = range * b1;
    sum += std::pow(range / point.norm() - 1.0, 2);
    predicted = RangeError(map, map.landmark(0));
  }
  const double observed = std::sqrt(sum / kTrials);
  EXPECT_GT(predicted, 0.5 * observed);
  EXPECT_LT(predicted, 2.0 * observed);
}

TEST(SparseDepth, ConfidenceGrowsWithParallaxAndObservations) {
  SyntheticScene scene(300);
  const Map two = scene.MakeMap(Walk(2, {-0.2, 0.1, 0.0}), 300);
  const Map six = scene.MakeMap(Walk(6, {-0.2, 0.1, 0.0}), 300);
  const auto mean = [](const std::vector<SparsePoint>& points) {
    double sum = 0;
    for (const SparsePoint& point : points) {
      EXPECT_GE(point.confidence, 0.5);
      EXPECT_LE(point.confidence, 1.0);
      sum += point.confidence;
    }
    return sum / static_cast<double>(points.size());
  };
  EXPECT_GT(mean(ProjectLandmarks(six, 1, kCamera, {})),
            mean(ProjectLandmarks(two, 1, kCamera, {})) + 0.1);
}

}  // namespace
}  // namespace orb360
