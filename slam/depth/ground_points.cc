#include "slam/depth/ground_points.h"

#include <cmath>
#include <vector>

#include <orb360/nn/base/check.h>

namespace orb360 {

bool AddGroundPoints(const Eigen::Vector3d& up, double height, const GroundPointOptions& options,
                     SparseDepth* sparse) {
  ORB360_CHECK(height > 0 && options.spacing > 0, height, options.spacing);
  const EquirectangularCamera camera(sparse->range.cols, sparse->range.rows);
  const cv::Rect image({}, sparse->range.size());
  struct Point {
    cv::Point pixel;
    double range;
  };
  std::vector<Point> missing;
  int num_known = 0;
  for (int top = 0; top < camera.height(); top += options.spacing) {
    for (int left = 0; left < camera.width(); left += options.spacing) {
      const cv::Rect square = cv::Rect(left, top, options.spacing, options.spacing) & image;
      const cv::Point middle(square.x + square.width / 2, square.y + square.height / 2);
      const double down = -up.dot(camera.Bearing({middle.x + 0.5, middle.y + 0.5}));
      if (down < std::sin(options.min_depression)) continue;
      if (cv::countNonZero(sparse->range(square)) > 0) {
        ++num_known;
      } else {
        missing.push_back({middle, height / down});
      }
    }
  }
  const auto count = static_cast<double>(num_known) + static_cast<double>(missing.size());
  if (num_known >= options.min_known * count) return false;
  const auto confidence =
      static_cast<float>(SparseConfidence(options.relative_error, options.sparse));
  for (const Point& point : missing) {
    sparse->range.at<float>(point.pixel) = static_cast<float>(point.range);
    sparse->confidence.at<float>(point.pixel) = confidence;
  }
  return true;
}

}  // namespace orb360
