#include "slam/depth/metric_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/check.h"
#include "slam/geometry/camera.h"
#include "slam/geometry/ground_plane.h"

namespace orb360 {
namespace {

constexpr int kMaxPoints = 2000;  // of the plane; more only take time

// Of the pixels between `bottom` and the horizon, about equally many for each solid angle.
std::vector<Eigen::Vector3d> GroundPoints(const DenseDepth& depth, const cv::Mat& ground,
                                          double min_probability) {
  const EquirectangularCamera camera(depth.range.cols, depth.range.rows);
  // Pixels of a step from row to row and, on the equator, from column to column.
  const double lower_half = 0.5 * depth.range.rows * depth.range.cols;
  const int step = std::max(1, static_cast<int>(std::sqrt(lower_half / kMaxPoints)));
  std::vector<Eigen::Vector3d> points;
  for (int y = depth.range.rows / 2; y < depth.range.rows; y += step) {
    const double latitude = camera.AngleOfPixels(y + 0.5 - 0.5 * depth.range.rows);
    const int across = std::max(step, static_cast<int>(std::lround(step / std::cos(latitude))));
    for (int x = 0; x < depth.range.cols; x += across) {
      const float range = depth.range.at<float>(y, x);
      if (!(range > 0)) continue;
      if (!ground.empty() && !(ground.at<float>(y, x) >= min_probability)) continue;
      points.push_back(range * camera.Bearing({x + 0.5, y + 0.5}));
    }
  }
  return points;
}

// The value that half of the weight lies below.
template <typename Value>
double WeightedMedian(std::vector<ScaleMeasurement> measurements, const Value& value) {
  std::sort(measurements.begin(), measurements.end(),
            [&](const auto& a, const auto& b) { return value(a) < value(b); });
  const auto weight = [](const ScaleMeasurement& m) { return 1 / (m.sigma * m.sigma); };
  double total = 0;
  for (const ScaleMeasurement& m : measurements) total += weight(m);
  double below = 0;
  for (const ScaleMeasurement& m : measurements) {
    below += weight(m);
    if (2 * below >= total) return value(m);
  }
  return value(measurements.back());
}

}  // namespace

std::optional<ScaleMeasurement> MeasureScale(const DenseDepth& depth, const cv::Mat& ground,
                                             double camera_height, const Eigen::Vector3d& up,
                                             std::optional<double> guess,
                                             const MetricScaleOptions& options) {
  ORB360_CHECK(depth.range.type() == CV_32F && camera_height > 0, camera_height);
  ORB360_CHECK(ground.empty() || ground.size() == depth.range.size(), ground.cols, ground.rows);
  const std::vector<Eigen::Vector3d> points =
      GroundPoints(depth, ground, options.min_ground_probability);
  const std::optional<GroundPlane> plane = FitGroundPlane(points, up, {});
  if (!plane) return std::nullopt;
  const double log_scale = std::log(camera_height / plane->height);
  if (guess && !(std::abs(log_scale - *guess) <= options.max_disagreement)) return std::nullopt;
  double square = 0;  // of the points' distances from the plane, as shares of the height
  for (const int i : plane->points) {
    const double distance = plane->normal.dot(points[static_cast<size_t>(i)]) / plane->height + 1;
    square += distance * distance;
  }
  // Neighbouring pixels are wrong together: their spread does not shrink with their number.
  const double spread = square / static_cast<double>(plane->points.size());
  return ScaleMeasurement{log_scale,
                          std::sqrt(options.height_sigma * options.height_sigma + spread)};
}

std::optional<ScaleMeasurement> FuseScales(std::span<const ScaleMeasurement> measurements) {
  if (measurements.empty()) return std::nullopt;
  const std::vector<ScaleMeasurement> all(measurements.begin(), measurements.end());
  const double median = WeightedMedian(all, [](const auto& m) { return m.log_scale; });
  const double deviation =
      WeightedMedian(all, [&](const auto& m) { return std::abs(m.log_scale - median); });
  double certainty = 0;
  for (const ScaleMeasurement& m : all) certainty += 1 / (m.sigma * m.sigma);
  // Of a normal distribution, from the median deviation to the standard deviation, and from there
  // to that of the median of so many.
  constexpr double kDeviationToSigma = 1.4826;
  constexpr double kMeanToMedian = 1.2533;
  const double of_spread =
      kDeviationToSigma * kMeanToMedian * deviation / std::sqrt(static_cast<double>(all.size()));
  return ScaleMeasurement{median, std::max(of_spread, kMeanToMedian / std::sqrt(certainty))};
}

}  // namespace orb360
