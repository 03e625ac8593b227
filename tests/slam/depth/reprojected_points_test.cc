#include "slam/depth/reprojected_points.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/depth/range_room.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);
const RangeRoom kRoom;
const Rigid3 kPose = TurnedCamera({0.2, 0.1, 0}, 0.3);

std::vector<DepthView> OtherViews(double confidence = 0.98) {
  std::vector<DepthView> views;
  for (const double x : {-1.0, -0.5, 0.7, 1.2}) {
    const Rigid3 pose = TurnedCamera({x, 0.2, 0.1}, 0.2 * x);
    views.emplace_back(kRoom.Render(kCamera, pose, std::nullopt, confidence), pose, 0.01);
  }
  return views;
}

SparseDepth NoPoints() {
  const cv::Size size(kCamera.width(), kCamera.height());
  return {cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F)};
}

void Add(const std::vector<DepthView>& views, SparseDepth* sparse, int num_threads = 1) {
  std::vector<const DepthView*> others;
  for (const DepthView& view : views) others.push_back(&view);
  AddReprojectedPoints(kPose, others, {}, sparse, num_threads);
}

int CountPoints(const SparseDepth& sparse) { return cv::countNonZero(sparse.range > 0); }

TEST(AddReprojectedPoints, GivesMostSquaresATrueRange) {
  SparseDepth sparse = NoPoints();
  Add(OtherViews(), &sparse);
  const int num_squares = (kCamera.width() / 6 + 1) * (kCamera.height() / 6 + 1);
  EXPECT_GT(CountPoints(sparse), num_squares / 2);
  EXPECT_LE(CountPoints(sparse), num_squares);
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const float range = sparse.range.at<float>(row, column);
      if (!(range > 0)) continue;
      // A point lies anywhere in its pixel.
      double least = 1e9;
      double most = 0;
      for (const double u : {0.0, 1.0}) {
        for (const double v : {0.0, 1.0}) {
          const Eigen::Vector3d ray = kPose.rotation * kCamera.Bearing({column + u, row + v});
          const double truth = kRoom.RangeOfWalls(kPose.translation, ray);
          least = std::min(least, truth);
          most = std::max(most, truth);
        }
      }
      EXPECT_GT(range, 0.99 * least) << row << " " << column;
      EXPECT_LT(range, 1.01 * most) << row << " " << column;
      EXPECT_GT(sparse.confidence.at<float>(row, column), 0.5);
    }
  }
}

TEST(AddReprojectedPoints, LeavesSquaresThatHaveAPoint) {
  SparseDepth sparse = NoPoints();
  sparse.range.at<float>(62, 100) = 2.5F;
  sparse.confidence.at<float>(62, 100) = 0.7F;
  Add(OtherViews(), &sparse);
  EXPECT_EQ(cv::countNonZero(sparse.range(cv::Rect(96, 60, 6, 6))), 1);
  EXPECT_EQ(sparse.range.at<float>(62, 100), 2.5F);
}

TEST(AddReprojectedPoints, LeavesOutWhatANearerPointHides) {
  SparseDepth sparse = NoPoints();
  sparse.range.at<float>(62, 100) = 0.5F;  // The walls are farther than 1.5 m.
  sparse.confidence.at<float>(62, 100) = 0.7F;
  Add(OtherViews(), &sparse);
  EXPECT_EQ(cv::countNonZero(sparse.range(cv::Rect(84, 48, 30, 30))), 1);
}

TEST(AddReprojectedPoints, OneViewAloneIsNotBelieved) {
  SparseDepth sparse = NoPoints();
  std::vector<DepthView> views = OtherViews();
  views.resize(1, views.front());
  Add(views, &sparse);
  EXPECT_EQ(CountPoints(sparse), 0);
}

TEST(AddReprojectedPoints, UncertainRangesAreNotTaken) {
  SparseDepth sparse = NoPoints();
  Add(OtherViews(0.92), &sparse);
  EXPECT_EQ(CountPoints(sparse), 0);
}

TEST(AddReprojectedPoints, IsTheSameForAnyNumberOfThreads) {
  SparseDepth one = NoPoints();
  SparseDepth three = NoPoints();
  Add(OtherViews(), &one, 1);
  Add(OtherViews(), &three, 3);
  EXPECT_EQ(cv::norm(one.range, three.range, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(one.confidence, three.confidence, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace orb360
