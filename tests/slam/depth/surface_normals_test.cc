#include "slam/depth/surface_normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/depth/range_room.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);
const RangeRoom kRoom;
const Rigid3 kPose = TurnedCamera({0.5, -0.4, 0.2}, 0.7);

/// Whether all pixels that a pixel's plane is fitted to show the same wall.
bool IsOnOneWall(const cv::Mat& color, int row, int column) {
  for (int y = std::max(0, row - 2); y <= std::min(color.rows - 1, row + 2); ++y) {
    const int step = ColumnStep(std::cos(std::numbers::pi * (0.5 - (y + 0.5) / color.rows)));
    for (int i = -2; i <= 2; ++i) {
      const int x = (column + i * step + color.cols) % color.cols;
      if (color.at<cv::Vec3b>(y, x) != color.at<cv::Vec3b>(row, column)) return false;
    }
  }
  return true;
}

TEST(FitNormals, AreThoseOfTheWallsSeamAndPolesIncluded) {
  const DenseDepth depth = kRoom.Render(kCamera, kPose);
  const DepthView view(depth, kPose, 0.01);
  ForEachDispatchTarget([&] {
    int tested = 0;
    int at_seam = 0;
    int at_poles = 0;
    for (int row = 0; row < kCamera.height(); ++row) {
      TestedRow points;
      points.Clear(row);
      // From different columns on: not a multiple of lanes, and each column in each lane.
      for (int column = row % 16; column < kCamera.width(); ++column) {
        points.Add(column, view.BearingOf(row, column), view.range(row, column));
      }
      points.Close();
      FitNormals(view, &points);
      for (size_t i = 0; i < points.size; ++i) {
        const int column = points.column[i];
        const Eigen::Vector3f normal(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
        const Eigen::Vector3f bearing = view.BearingOf(row, column);
        ASSERT_NEAR(normal.norm(), 1.0, 1e-5);
        ASSERT_LT(normal.dot(bearing), 0.0);
        // Where walls meet, the plane lies between both.
        if (!IsOnOneWall(depth.color, row, column)) continue;
        const Eigen::Vector3d truth =
            kRoom.NormalAlong(kPose, bearing.cast<double>(), view.range(row, column));
        EXPECT_GT(normal.cast<double>().dot(truth), std::cos(0.01)) << row << ' ' << column;
        ++tested;
        at_seam += column < 2 || column >= kCamera.width() - 2;
        at_poles += row < 2 || row >= kCamera.height() - 2;
      }
    }
    EXPECT_GT(tested, 25000);
    EXPECT_GT(at_seam, 200);
    EXPECT_GT(at_poles, 900);
  });
}

TEST(FitNormals, FaceTheCameraWhereAPixelIsAloneAndAreZeroWhereItIsUnknown) {
  DenseDepth depth = kRoom.Render(kCamera, kPose);
  depth.range(cv::Rect(90, 50, 21, 21)) = 0;
  depth.range.at<float>(60, 100) = 2.0f;
  const DepthView view(depth, kPose, 0.01);
  ForEachDispatchTarget([&] {
    TestedRow points;
    points.Clear(60);
    points.Add(100, view.BearingOf(60, 100), 2.0f);
    points.Add(95, view.BearingOf(60, 95), 2.0f);  // nothing is known around it
    points.Add(90, view.BearingOf(60, 90), 2.0f);  // but here on one side
    points.Close();
    FitNormals(view, &points);
    const auto normal = [&](size_t i) {
      return Eigen::Vector3f(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
    };
    EXPECT_LT((normal(0) + view.BearingOf(60, 100)).norm(), 1e-5);
    EXPECT_EQ(normal(1), Eigen::Vector3f::Zero());
    EXPECT_EQ(normal(2), Eigen::Vector3f::Zero());
  });
}

}  // namespace
}  // namespace orb360
