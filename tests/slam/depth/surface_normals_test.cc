#include "slam/depth/surface_normals.h"

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/depth/range_room.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);
const RangeRoom kRoom;
const Rigid3 kPose = TurnedCamera({0.5, -0.4, 0.2}, 0.7);

TEST(FitNormals, AreThoseOfTheWallsSeamAndPolesIncluded) {
  const DepthView view(kRoom.Render(kCamera, kPose), kPose, 1.0, 0.01);
  ForEachDispatchTarget([&] {
    int wrong = 0;
    int wrong_at_border = 0;
    for (int row = 0; row < kCamera.height(); ++row) {
      TestedRow points;
      points.Clear(row);
      for (int column = 0; column < kCamera.width() - 3; ++column) {  // Not a multiple of lanes.
        points.Add(column, view.BearingOf(row, column), view.range(row, column));
      }
      points.Close();
      FitNormals(view, &points);
      for (size_t i = 0; i < points.size; ++i) {
        const Eigen::Vector3f normal(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
        ASSERT_NEAR(normal.norm(), 1.0, 1e-5);
        const Eigen::Vector3f bearing = view.BearingOf(row, points.column[i]);
        ASSERT_LT(normal.dot(bearing), 0.0);
        const Eigen::Vector3d truth =
            kRoom.NormalAlong(kPose, bearing.cast<double>(), view.range(row, points.column[i]));
        const bool is_wrong = normal.cast<double>().dot(truth) < std::cos(0.03);
        wrong += is_wrong;
        if (row < 2 || row >= kCamera.height() - 2 || i == 0) wrong_at_border += is_wrong;
      }
    }
    // Near the edges of the room the planes of two walls are mixed.
    EXPECT_LT(wrong, 0.25 * kCamera.width() * kCamera.height());
    EXPECT_LT(wrong_at_border, 0.25 * (4 * kCamera.width() + kCamera.height()));
  });
}

TEST(FitNormals, ThereIsNoneAroundAPixelThatIsAlone) {
  DenseDepth depth = kRoom.Render(kCamera, kPose);
  depth.range(cv::Rect(90, 50, 21, 21)) = 0;
  depth.range.at<float>(60, 100) = 2.0f;
  const DepthView view(depth, kPose, 1.0, 0.01);
  TestedRow points;
  points.Clear(60);
  points.Add(100, view.BearingOf(60, 100), 2.0f);
  points.Close();
  FitNormals(view, &points);
  // Nothing tells how it lies: it faces the camera.
  const Eigen::Vector3f normal(points.normal[0][0], points.normal[1][0], points.normal[2][0]);
  EXPECT_LT((normal + view.BearingOf(60, 100)).norm(), 1e-5);
}

}  // namespace
}  // namespace orb360
