#include "slam/depth/source_view.h"

#include <algorithm>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/depth/range_room.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);
const RangeRoom kRoom;
const Rigid3 kPose = TurnedCamera({0.5, -0.4, 0.2}, 0.7);

/// Points in these directions, `excess` times as far away as the walls, with an own error of 1 %.
TestedRow PointsAt(const std::vector<Eigen::Vector3d>& bearings, double excess = 1.0) {
  TestedRow points;
  points.Clear(0);
  std::vector<Eigen::Vector3d> normals;
  for (const Eigen::Vector3d& bearing : bearings) {
    const double range = kRoom.RangeOfWalls(kPose.translation, kPose.rotation * bearing);
    points.Add(0, bearing.cast<float>(), static_cast<float>(excess * range));
    normals.push_back(kRoom.NormalAlong(kPose, bearing, range));
  }
  points.Close();
  for (size_t i = 0; i < points.size; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      points.normal[static_cast<size_t>(axis)][i] = static_cast<float>(normals[i][axis]);
    }
    points.variance[i] = 1e-4f * points.range[i] * points.range[i];
  }
  return points;
}

/// Over the whole sphere, seeded.
std::vector<Eigen::Vector3d> RandomBearings(int count) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> bearings;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d v(normal(random), normal(random), normal(random));
    bearings.push_back(v.normalized());
  }
  return bearings;
}

DepthView ViewOf(const DenseDepth& depth) { return {depth, kPose, 0.01}; }

/// The same camera once more.
SourceView Itself(const DepthView& view) { return {&view, {}, 2.5, 0.01, 0.8f}; }

TEST(CompareWithSourceView, RangesBetweenPixelsAreThoseOfThePlaneSeamAndPolesIncluded) {
  const DepthView view = ViewOf(kRoom.Render(kCamera, kPose));
  std::vector<Eigen::Vector3d> bearings = RandomBearings(5000);
  const size_t num_random = bearings.size();
  for (const double latitude : {-1.57, -1.2, 0.0, 1.2, 1.57}) {
    for (const double turn : {-0.012, -0.004, 0.004, 0.012}) {  // Pixels are 0.025 wide.
      const double longitude = std::numbers::pi + turn;
      bearings.emplace_back(-std::cos(latitude) * std::cos(longitude),
                            std::cos(latitude) * std::sin(longitude), std::sin(latitude));
    }
  }
  ForEachDispatchTarget([&] {
    TestedRow points = PointsAt(bearings);
    CompareWithSourceView(Itself(view), &points);
    int near_edges = 0;
    for (size_t i = 0; i < points.size; ++i) {
      ASSERT_EQ(points.conflict[i], 0) << bearings[i].transpose();
      const bool is_right =
          points.support[i] == 1 &&
          std::abs(points.shift[i] / points.information[i]) < 0.002f * points.range[i];
      // Where two walls meet, four pixels see two planes.
      near_edges += !is_right;
      if (i >= num_random) {
        EXPECT_TRUE(is_right) << bearings[i].transpose();
      }
    }
    EXPECT_LT(near_edges, 150);
  });
}

TEST(CompareWithSourceView, KnowsHowFarTheSurfaceIsAlongTheNormalAndHowSureItIs) {
  const DepthView view = ViewOf(kRoom.Render(kCamera, kPose, std::nullopt, 1.0 / 1.04));
  const std::vector<Eigen::Vector3d> bearings = RandomBearings(1000);
  ForEachDispatchTarget([&] {
    TestedRow points = PointsAt(bearings, 1.02);
    CompareWithSourceView(Itself(view), &points);
    int wrong = 0;
    for (size_t i = 0; i < points.size; ++i) {
      const Eigen::Vector3d normal(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
      const double slant = bearings[i].dot(normal);
      if (slant > -kMinIncidence) continue;
      const double wall = points.range[i] / 1.02;
      // Confidence is kept in steps of 1/255: 4.08 % for 4.
      const double error = (255.0 / 245.0 - 1.0) * wall * -slant;
      const double offset = -0.02 * wall * slant;
      const double expected[] = {1.0 / (error * error), 1.0 / (error * error),
                                 offset / (error * error)};
      const double heard[] = {points.information[i], points.best[i], points.shift[i]};
      for (int k = 0; k < 3; ++k) {
        wrong += !(std::abs(heard[k] / expected[k] - 1.0) < (k == 2 ? 0.2 : 0.02));
      }
    }
    EXPECT_LT(wrong, 150);  // near edges
  });
}

TEST(CompareWithSourceView, LooksThroughWhatIsNearerButHidesWhatIsBehind) {
  const DepthView view = ViewOf(kRoom.Render(kCamera, kPose));
  const std::vector<Eigen::Vector3d> bearings = RandomBearings(1000);
  ForEachDispatchTarget([&] {
    TestedRow nearer = PointsAt(bearings, 0.7);
    CompareWithSourceView(Itself(view), &nearer);
    TestedRow behind = PointsAt(bearings, 1.4);
    CompareWithSourceView(Itself(view), &behind);
    for (size_t i = 0; i < bearings.size(); ++i) {
      EXPECT_EQ(nearer.conflict[i], 1);
      EXPECT_EQ(nearer.support[i] + nearer.information[i] + nearer.shift[i], 0);
      EXPECT_EQ(behind.conflict[i] + behind.support[i] + behind.information[i], 0);
    }
  });
}

TEST(CompareWithSourceView, DoesNotTakeASurfaceTurnedAwayFromItForTheOneThatItSees) {
  const DepthView view = ViewOf(kRoom.Render(kCamera, kPose));
  ForEachDispatchTarget([&] {
    TestedRow points = PointsAt(RandomBearings(100));
    for (TestedRow::Array& axis : points.normal) {
      for (float& value : axis) value = -value;
    }
    CompareWithSourceView(Itself(view), &points);
    int supported = 0;
    for (size_t i = 0; i < points.size; ++i) supported += points.support[i] > 0;
    EXPECT_LT(supported, 30);  // those seen at a grazing angle
  });
}

TEST(CompareWithSourceView, SaysNothingBesideEdgesOfWhatIsNearAndWhereNothingIsKnown) {
  DenseDepth depth = kRoom.Render(kCamera, kPose);
  depth.range.at<float>(60, 0) = 0.3f;  // one pixel of something near, at the seam
  depth.range.at<float>(30, 100) = 0;   // one that is unknown
  const DepthView view = ViewOf(depth);
  const auto bearing = [&](int row, int column) {
    return Eigen::Vector3d(view.BearingOf(row, column).cast<double>());
  };
  const std::vector<Eigen::Vector3d> bearings{bearing(60, 255), bearing(61, 1),  bearing(59, 0),
                                              bearing(30, 100), bearing(31, 99), bearing(60, 3)};
  ForEachDispatchTarget([&] {
    TestedRow points = PointsAt(bearings, 0.7);
    CompareWithSourceView(Itself(view), &points);
    for (size_t i = 0; i < 5; ++i) EXPECT_EQ(points.conflict[i], 0) << i;
    EXPECT_EQ(points.conflict[5], 1);
  });
}

TEST(CompareWithSourceView, PosesBringThePointsToTheSourceView) {
  const Rigid3 other = TurnedCamera({-0.8, 0.7, -0.3}, -1.1);
  const DepthView view(kRoom.Render(kCamera, other), other, 0.01);
  ForEachDispatchTarget([&] {
    TestedRow points = PointsAt(RandomBearings(1000));
    const SourceView source{&view, other.Inverse() * kPose, 2.5, 0.01, 0.8f};
    CompareWithSourceView(source, &points);
    CompareWithSourceView(source, &points);  // What they say adds up.
    const auto all = static_cast<std::ptrdiff_t>(points.size);
    EXPECT_GT(std::count(points.support.begin(), points.support.begin() + all, 2.0f), 900);
    EXPECT_EQ(std::count(points.conflict.begin(), points.conflict.begin() + all, 2.0f), 0);
  });
}

}  // namespace
}  // namespace orb360
