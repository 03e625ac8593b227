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

cv::Mat Gray(int value) {
  return {kCamera.height(), kCamera.width(), CV_8UC3, cv::Scalar::all(value)};
}

void Add(const std::vector<DepthView>& views, SparseDepth* sparse, int num_threads = 1,
         const cv::Mat& colors = Gray(100), const cv::Mat& others_colors = Gray(100)) {
  std::vector<SeenView> others;
  for (const DepthView& view : views) others.push_back({&view, &others_colors});
  AddReprojectedPoints(kPose, colors, others, {}, sparse, num_threads);
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

TEST(AddReprojectedPoints, LeavesOutWhatLooksDifferentHere) {
  SparseDepth everywhere = NoPoints();
  Add(OtherViews(), &everywhere);
  // Something dark that nobody measured stands before a part of the walls.
  const cv::Rect dark(96, 42, 48, 30);  // Of whole squares.
  cv::Mat colors = Gray(100);
  colors(dark).setTo(cv::Scalar(100, 100, 40));
  SparseDepth sparse = NoPoints();
  Add(OtherViews(), &sparse, 1, colors);
  EXPECT_GT(cv::countNonZero(everywhere.range(dark)), 30);
  EXPECT_EQ(cv::countNonZero(sparse.range(dark)), 0);
  everywhere.range(dark).setTo(0);
  EXPECT_EQ(cv::norm(sparse.range, everywhere.range, cv::NORM_INF), 0);
}

TEST(AddReprojectedPoints, ExposureAndWhiteBalanceOfEachViewDoNotMatter) {
  SparseDepth same = NoPoints();
  Add(OtherViews(), &same);
  SparseDepth sparse = NoPoints();
  cv::Mat colors = Gray(0);
  colors.setTo(cv::Scalar(40, 80, 160));
  Add(OtherViews(), &sparse, 1, colors, Gray(120));
  EXPECT_EQ(cv::norm(sparse.range, same.range, cv::NORM_INF), 0);
}

TEST(SurfaceColors, IsTheImageOfTheSizeOfTheDepthBlurred) {
  cv::Mat image(64, 128, CV_8UC3, cv::Scalar(10, 20, 30));
  image.colRange(64, 128).setTo(cv::Scalar(50, 60, 70));
  const cv::Mat colors = SurfaceColors(image, {64, 32});
  EXPECT_EQ(colors.size(), cv::Size(64, 32));
  EXPECT_EQ(colors.type(), CV_8UC3);
  EXPECT_EQ(colors.at<cv::Vec3b>(16, 10), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(colors.at<cv::Vec3b>(16, 50), cv::Vec3b(50, 60, 70));
  const auto edge = colors.at<cv::Vec3b>(16, 31);
  EXPECT_GT(edge[0], 10);
  EXPECT_LT(edge[0], 50);
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
