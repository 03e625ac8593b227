#include "slam/viewer/live_cloud.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "slam/depth/fusion_confidence.h"
#include "slam/io/byte_number.h"
#include "slam/io/optical_frame.h"
#include "slam/viewer/live_landmarks.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

constexpr std::uint64_t kViewsAtOnce = 16;  // 1.3 MB
constexpr float kMinConfidence = 1 / 1.1f;  // of 1 / (1 + relative error)

/// The i-th of directions that are evenly spread over the sphere, whatever their number is: the
/// sequence R2 (Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018), by equal
/// areas.
Eigen::Vector3d SpreadDirection(int i) {
  constexpr double kPlastic = 1.32471795724474602596;  // x^3 = x + 1
  const auto fraction = [](double value) { return value - std::floor(value); };
  const double longitude = 2 * std::numbers::pi * fraction(0.5 + i / kPlastic);
  const double z = 2 * fraction(0.5 + i / (kPlastic * kPlastic)) - 1;
  const double radius = std::sqrt(1 - z * z);
  return {-radius * std::cos(longitude), radius * std::sin(longitude), z};
}

}  // namespace

std::vector<ThinnedView::Point> ThinView(const DenseDepth& depth, int max_points) {
  ORB360_CHECK(depth.range.type() == CV_32FC1 && depth.color.type() == CV_8UC3 &&
               depth.confidence.size() == depth.range.size() &&
               depth.color.size() == depth.range.size());
  const EquirectangularCamera camera(depth.range.cols, depth.range.rows);
  const cv::Mat confidences = FusionConfidence(depth);
  std::vector<ThinnedView::Point> points;
  // About half of a street's directions show the sky.
  for (int i = 0; i < 2 * max_points && static_cast<int>(points.size()) < max_points; ++i) {
    const Eigen::Vector3d direction = SpreadDirection(i);
    const Eigen::Vector2d pixel = camera.Project(direction);
    const int column = std::min(static_cast<int>(pixel.x()), depth.range.cols - 1);
    const int row = std::min(static_cast<int>(pixel.y()), depth.range.rows - 1);
    const float range = depth.range.at<float>(row, column);
    if (!(range > 0) || !std::isfinite(range)) continue;
    if (!(confidences.at<float>(row, column) >= kMinConfidence)) continue;
    const auto& bgr = depth.color.at<cv::Vec3b>(row, column);
    const Eigen::Vector3d middle = camera.Bearing({column + 0.5, row + 0.5});
    points.push_back({(range * middle).cast<float>(), {bgr[2], bgr[1], bgr[0]}});
  }
  return points;
}

void LiveCloud::Add(int frame, const Rigid3& world_from_camera, const DenseDepth& depth) {
  size_t max_of_view = 0;
  {
    const std::lock_guard lock(mutex_);
    max_of_view = max_of_view_;
  }
  auto view = std::make_shared<ThinnedView>(
      ThinnedView{frame, world_from_camera, ThinView(depth, static_cast<int>(max_of_view))});
  const std::lock_guard lock(mutex_);
  num_points_ += view->points.size();
  views_.push_back(std::move(view));
  if (num_points_ <= max_points_ || max_of_view_ == 1) return;
  max_of_view_ /= 2;
  num_points_ = 0;
  for (std::shared_ptr<const ThinnedView>& kept : views_) {
    // A page may be getting the old one.
    auto halved = std::make_shared<ThinnedView>(*kept);
    halved->points.resize(std::min(halved->points.size(), max_of_view_));
    halved->points.shrink_to_fit();
    num_points_ += halved->points.size();
    kept = std::move(halved);
  }
}

size_t LiveCloud::num_views() const {
  const std::lock_guard lock(mutex_);
  return views_.size();
}

std::string LiveCloud::Bytes(std::uint64_t since) const {
  std::vector<std::shared_ptr<const ThinnedView>> views;
  size_t max_of_view = 0;
  std::uint64_t end = 0;
  {
    const std::lock_guard lock(mutex_);
    const std::uint64_t begin = std::min<std::uint64_t>(since, views_.size());
    end = std::min<std::uint64_t>(begin + kViewsAtOnce, views_.size());
    views.assign(views_.begin() + static_cast<std::ptrdiff_t>(begin),
                 views_.begin() + static_cast<std::ptrdiff_t>(end));
    max_of_view = max_of_view_;
  }
  std::string bytes;
  AppendLittleEndian(static_cast<std::uint32_t>(end), &bytes);
  AppendLittleEndian(static_cast<std::uint32_t>(max_of_view), &bytes);
  for (const auto& view : views) {
    AppendLittleEndian(static_cast<std::int32_t>(view->frame), &bytes);
    const Rigid3 pose = WorldFromOptical(view->world_from_camera);
    for (const double value : pose.translation) {
      AppendLittleEndian(static_cast<float>(value), &bytes);
    }
    for (const double value : pose.rotation.coeffs()) {
      AppendLittleEndian(static_cast<float>(value), &bytes);
    }
    AppendLittleEndian(static_cast<std::uint32_t>(view->points.size()), &bytes);
    for (const ThinnedView::Point& point : view->points) {
      AppendLivePoint(point.position, point.color, &bytes);
    }
  }
  return bytes;
}

}  // namespace orb360
