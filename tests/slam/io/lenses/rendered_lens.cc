#include "tests/slam/io/lenses/rendered_lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {

cv::Vec3b SphereColor(const Eigen::Vector3d& bearing) {
  cv::Vec3b color;
  for (int i = 0; i < 3; ++i) {
    const double wave = std::sin(5.0 * bearing[i] + 3.0 * bearing[(i + 1) % 3] + i);
    color[i] = cv::saturate_cast<uchar>(128.0 + 60.0 * bearing[i] + 40.0 * wave);
  }
  return color;
}

cv::Mat RenderLens(
    cv::Size size,
    const std::function<std::optional<Eigen::Vector3d>(double x, double y)>& bearing_of) {
  cv::Mat image = cv::Mat::zeros(size, CV_8UC3);
  for (int row = 0; row < size.height; ++row) {
    for (int col = 0; col < size.width; ++col) {
      const std::optional<Eigen::Vector3d> bearing = bearing_of(col + 0.5, row + 0.5);
      if (bearing) image.at<cv::Vec3b>(row, col) = SphereColor(*bearing);
    }
  }
  return image;
}

cv::Mat RenderSphere(cv::Size size,
                     const std::function<cv::Vec3b(const Eigen::Vector3d&)>& color_of) {
  const EquirectangularCamera camera(size.width, size.height);
  cv::Mat image(size, CV_8UC3);
  for (int row = 0; row < size.height; ++row) {
    for (int col = 0; col < size.width; ++col) {
      image.at<cv::Vec3b>(row, col) = color_of(camera.Bearing({col + 0.5, row + 0.5}));
    }
  }
  return image;
}

FeatureErrors CompareFeatures(const cv::Mat& a, const cv::Mat& b) {
  constexpr int kHalfPatch = 10;     // pixels
  constexpr int kHalfSearch = 12;    // pixels around it
  constexpr double kMinScore = 0.8;  // normalized correlation
  cv::Mat grays[2];
  cv::cvtColor(a, grays[0], cv::COLOR_BGR2GRAY);
  cv::cvtColor(b, grays[1], cv::COLOR_BGR2GRAY);
  cv::Mat mask = cv::Mat::zeros(a.size(), CV_8U);
  const int border = kHalfPatch + kHalfSearch;
  mask(cv::Range(a.rows / 6, a.rows - a.rows / 6), cv::Range(border, a.cols - border)) = 255;
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(grays[0], corners, 2000, 0.01, 8.0, mask);
  const EquirectangularCamera camera(a.cols, a.rows);
  std::vector<double> angles;
  for (const cv::Point2f& corner : corners) {
    const cv::Point at(cvRound(corner.x), cvRound(corner.y));
    const auto square = [&](int half) {
      return cv::Rect(at.x - half, at.y - half, 2 * half + 1, 2 * half + 1);
    };
    cv::Mat scores;
    cv::matchTemplate(grays[1](square(border)), grays[0](square(kHalfPatch)), scores,
                      cv::TM_CCOEFF_NORMED);
    double score = 0.0;
    cv::Point best;
    cv::minMaxLoc(scores, nullptr, &score, nullptr, &best);
    const cv::Rect inside(1, 1, scores.cols - 2, scores.rows - 2);
    if (score < kMinScore || !inside.contains(best)) continue;
    const auto vertex = [&](cv::Point step) {  // of the parabola through three scores
      const double before = scores.at<float>(best - step);
      const double after = scores.at<float>(best + step);
      return 0.5 * (before - after) / (before - 2.0 * score + after);
    };
    const double x = at.x + best.x - kHalfSearch + vertex({1, 0});
    const double y = at.y + best.y - kHalfSearch + vertex({0, 1});
    const Eigen::Vector3d p = camera.Bearing({at.x + 0.5, at.y + 0.5});
    const Eigen::Vector3d q = camera.Bearing({x + 0.5, y + 0.5});
    angles.push_back(std::atan2(p.cross(q).norm(), p.dot(q)) * 180.0 / std::numbers::pi);
  }
  std::ranges::sort(angles);
  if (angles.empty()) return {};
  return {static_cast<int>(angles.size()), angles[angles.size() / 2],
          angles[angles.size() * 9 / 10]};
}

double MedianColorDifference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  std::vector<int> sums;
  for (int row = 0; row < a.rows; ++row) {
    for (int col = 0; col < a.cols; ++col) {
      const cv::Vec3b& each = difference.at<cv::Vec3b>(row, col);
      sums.push_back(each[0] + each[1] + each[2]);
    }
  }
  std::ranges::nth_element(sums, sums.begin() + static_cast<long>(sums.size() / 2));
  return sums[sums.size() / 2] / 3.0;
}

}  // namespace orb360
