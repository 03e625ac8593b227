#include "slam/depth/dense_ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/geometry/ground_plane.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

constexpr int kMaxPoints = 2000;  // of the plane; more only take time
// Roads bend up and down. Within two heights of the camera the ground is treated as one plane; rad.
constexpr GroundPlaneOptions kNear{.min_below = 0.5};

// Returns points of pixels below the horizon, about equally many per solid angle.
std::vector<Eigen::Vector3d> GroundPoints(const DenseDepth& depth, double min_probability) {
  const EquirectangularCamera camera(depth.range.cols, depth.range.rows);
  // Step in pixels from row to row and, on the equator, from column to column.
  const double lower_half = 0.5 * depth.range.rows * depth.range.cols;
  const int step = std::max(1, static_cast<int>(std::sqrt(lower_half / kMaxPoints)));
  std::vector<Eigen::Vector3d> points;
  for (int y = depth.range.rows / 2; y < depth.range.rows; y += step) {
    const double latitude = camera.AngleOfPixels(y + 0.5 - 0.5 * depth.range.rows);
    const int across = std::max(step, static_cast<int>(std::lround(step / std::cos(latitude))));
    for (int x = 0; x < depth.range.cols; x += across) {
      const float range = depth.range.at<float>(y, x);
      if (!(range > 0)) continue;
      if (!depth.ground.empty() && !(depth.ground.at<float>(y, x) >= min_probability)) continue;
      points.push_back(range * camera.Bearing({x + 0.5, y + 0.5}));
    }
  }
  return points;
}

// Returns the weighted median.
template <typename Value>
double WeightedMedian(std::span<const DenseGround> grounds, const Value& value) {
  std::vector<DenseGround> sorted(grounds.begin(), grounds.end());
  std::ranges::sort(sorted, {}, value);
  const auto weight = [](const DenseGround& ground) { return 1 / (ground.sigma * ground.sigma); };
  double total = 0;
  for (const DenseGround& ground : sorted) total += weight(ground);
  double below = 0;
  for (const DenseGround& ground : sorted) {
    below += weight(ground);
    if (2 * below >= total) return value(ground);
  }
  return value(sorted.back());
}

}  // namespace

std::optional<DenseGround> FindGround(const DenseDepth& depth, const Eigen::Vector3d& up,
                                      const DenseGroundOptions& options) {
  ORB360_CHECK(depth.range.type() == CV_32F);
  ORB360_CHECK(depth.ground.empty() || depth.ground.size() == depth.range.size(), depth.ground.cols,
               depth.ground.rows);
  const std::vector<Eigen::Vector3d> points = GroundPoints(depth, options.min_probability);
  const std::optional<GroundPlane> plane = FitGroundPlane(points, up, kNear);
  if (!plane) return std::nullopt;
  const double log_height = std::log(plane->height);
  const std::optional<double>& guess = depth.log_camera_height;
  if (guess && !(std::abs(log_height - *guess) <= options.max_disagreement)) return std::nullopt;
  double square = 0;  // of the points' distances from the plane, as fractions of the height
  for (const int i : plane->points) {
    const double distance = plane->normal.dot(points[static_cast<size_t>(i)]) / plane->height + 1;
    square += distance * distance;
  }
  // Errors of neighbouring pixels are correlated, so the spread does not shrink with their number.
  const double spread = square / static_cast<double>(plane->points.size());
  return DenseGround{plane->normal, log_height,
                     std::sqrt(options.height_sigma * options.height_sigma + spread)};
}

std::optional<DenseGround> FuseGrounds(std::span<const DenseGround> grounds) {
  if (grounds.empty()) return std::nullopt;
  const double median = WeightedMedian(grounds, [](const DenseGround& g) { return g.log_height; });
  const double deviation = WeightedMedian(
      grounds, [&](const DenseGround& g) { return std::abs(g.log_height - median); });
  double certainty = 0;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const DenseGround& ground : grounds) {
    certainty += 1 / (ground.sigma * ground.sigma);
    up += ground.up;
  }
  // Factors, for a normal distribution, from the median deviation to the standard deviation, and
  // from that to the standard deviation of the median of so many values.
  constexpr double kDeviationToSigma = 1.4826;
  constexpr double kMeanToMedian = 1.2533;
  const double of_spread = kDeviationToSigma * kMeanToMedian * deviation /
                           std::sqrt(static_cast<double>(grounds.size()));
  return DenseGround{up.normalized(), median,
                     std::max(of_spread, kMeanToMedian / std::sqrt(certainty))};
}

}  // namespace orb360
