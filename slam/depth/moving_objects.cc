#include "slam/depth/moving_objects.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// The plane of the ground: normal . p + height = 0, camera frame.
struct Plane {
  explicit Plane(const DenseGround& ground)
      : normal(ground.up.cast<float>()), height(static_cast<float>(std::exp(ground.log_height))) {}

  /// By how much a ray comes nearer to the plane for each unit of range.
  float Fall(const Eigen::Vector3f& bearing) const { return -normal.dot(bearing); }

  Eigen::Vector3f normal;
  float height;
};

/// The range of a view in a direction, unit vector in its camera frame; 0 where unknown.
float RangeAlong(const DepthView& view, const Eigen::Vector3f& direction) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float longitude = std::atan2(direction.y(), -direction.x());
  const float latitude = std::asin(std::clamp(direction.z(), -1.0F, 1.0F));
  const auto row = static_cast<int>((0.5F - latitude / kPi) * static_cast<float>(view.height()));
  const auto column =
      static_cast<int>((longitude / (2 * kPi) + 0.5F) * static_cast<float>(view.width()));
  return view.range(std::clamp(row, 0, view.height() - 1), column % view.width());
}

/// What views see in the direction of places on the ground.
struct Sightings {
  int ground = 0;   ///< How often the ground.
  int through = 0;  ///< How often something behind it.

  /// Compares ranges, not depths below the plane: a view that is hardly above the plane, or below
  /// it, sees through it with rays that hardly fall.
  void Look(const DepthView& view, const Rigid3& view_from_reference, const Eigen::Vector3f& place,
            const MovingObjectOptions& options) {
    const Eigen::Vector3d seen = view_from_reference * Eigen::Vector3d(place.cast<double>());
    const double distance = seen.norm();
    if (!(distance > 0)) return;
    const double range = RangeAlong(view, (seen / distance).cast<float>());
    if (!(range > 0)) return;
    const double farther = range / distance - 1;
    if (farther > options.max_relative_farther) {
      ++through;
    } else if (farther > -options.max_relative_nearer) {
      ++ground;
    }
  }
};

/// A column without any mark, if there is one.
std::optional<int> EmptyColumn(const cv::Mat& marks) {
  for (int column = 0; column < marks.cols; ++column) {
    if (cv::countNonZero(marks.col(column)) == 0) return column;
  }
  return std::nullopt;
}

/// The columns from `first` on, and then those before it.
cv::Mat Turned(const cv::Mat& image, int first) {
  if (first == 0) return image;
  cv::Mat turned;
  cv::hconcat(image.colRange(first, image.cols), image.colRange(0, first), turned);
  return turned;
}

/// A column of a region below the ground.
struct RegionColumn {
  int column;
  std::vector<int> rows;  ///< Downward.
  double distance;        ///< Of the ground at its lowest row, horizontally.
  float median_range;
};

/// The rows above the highest one of a column whose ranges are like its own, downward from there.
int CountRowsAbove(const DepthView& view, const RegionColumn& region, const Plane& plane,
                   double max_height) {
  constexpr float kMaxRatio = 1.5F;  // of the ranges of one object
  constexpr float kFarther = 1.1F;   // of a range that is not right yet
  int count = 0;
  for (int row = region.rows.front() - 1; row >= 0; --row, ++count) {
    const float range = view.range(row, region.column);
    const double fall = plane.Fall(view.BearingOf(row, region.column));
    const double placed = region.distance / std::sqrt(1 - fall * fall);
    if (plane.height - placed * fall > max_height * plane.height) break;
    if (!(range > kFarther * placed)) break;
    if (range > kMaxRatio * region.median_range || range * kMaxRatio < region.median_range) break;
  }
  return count;
}

}  // namespace

cv::Mat FindBelowGround(const DepthView& view, const DenseGround& ground,
                        const MovingObjectOptions& options) {
  const Plane plane(ground);
  const auto tolerance = static_cast<float>(options.tolerance) * plane.height;
  const auto relative_tolerance = static_cast<float>(options.relative_tolerance);
  const auto min_fall = static_cast<float>(1 / options.max_ground_range);
  cv::Mat below = cv::Mat::zeros(view.height(), view.width(), CV_8U);
  for (int row = 0; row < view.height(); ++row) {
    for (int column = 0; column < view.width(); ++column) {
      const float range = view.range(row, column);
      const float fall = plane.Fall(view.BearingOf(row, column));
      if (!(range > 0 && fall > min_fall)) continue;
      if (fall * range - plane.height > tolerance + relative_tolerance * range) {
        below.at<std::uint8_t>(row, column) = 255;
      }
    }
  }
  return below;
}

std::vector<MovingObject> FindMovingObjects(const cv::Mat& below_ground, const DepthView& view,
                                            const DenseGround& ground,
                                            std::span<const DepthView* const> others,
                                            const MovingObjectOptions& options) {
  ORB360_CHECK(
      below_ground.type() == CV_8U && below_ground.size() == cv::Size(view.width(), view.height()),
      below_ground.type(), below_ground.size());
  const std::optional<int> start = EmptyColumn(below_ground);
  if (!start) return {};  // There is no ground around the camera.
  const Plane plane(ground);
  std::vector<Rigid3> other_from_view;
  for (const DepthView* other : others) {
    other_from_view.push_back(other->world_from_camera().Inverse() * view.world_from_camera());
  }
  cv::Mat labels;
  cv::Mat boxes;
  cv::Mat centroids;
  const int count =
      cv::connectedComponentsWithStats(Turned(below_ground, *start), labels, boxes, centroids);
  const double pixel_angle = std::numbers::pi / view.height();
  std::vector<MovingObject> objects;
  for (int label = 1; label < count; ++label) {
    const cv::Rect box(
        boxes.at<int>(label, cv::CC_STAT_LEFT), boxes.at<int>(label, cv::CC_STAT_TOP),
        boxes.at<int>(label, cv::CC_STAT_WIDTH), boxes.at<int>(label, cv::CC_STAT_HEIGHT));
    Sightings sightings;
    double solid_angle = 0;
    std::vector<float> ratios;  // of the ranges to those of the ground
    std::vector<RegionColumn> columns;
    for (int x = box.x; x < box.x + box.width; ++x) {
      const int column = (x + *start) % view.width();
      std::vector<int> rows;
      std::vector<float> ranges;
      for (int row = box.y; row < box.y + box.height; ++row) {
        if (labels.at<int>(row, x) != label) continue;
        rows.push_back(row);
        ranges.push_back(view.range(row, column));
        solid_angle += std::sin((row + 0.5) * pixel_angle) * pixel_angle * pixel_angle;
        const Eigen::Vector3f bearing = view.BearingOf(row, column);
        const float ground_range = plane.height / plane.Fall(bearing);
        ratios.push_back(ranges.back() / ground_range);
        const Eigen::Vector3f place = ground_range * bearing;
        for (size_t i = 0; i < others.size(); ++i) {
          sightings.Look(*others[i], other_from_view[i], place, options);
        }
      }
      const double fall = plane.Fall(view.BearingOf(rows.back(), column));
      columns.push_back(
          {column, rows, plane.height * std::sqrt(1 - fall * fall) / fall, Median(ranges)});
    }
    if (solid_angle < options.min_solid_angle || sightings.ground == 0) continue;
    if (Median(ratios) < options.min_range_ratio) continue;
    if (sightings.ground < options.min_ground_ratio * sightings.through) continue;
    MovingObject& object = objects.emplace_back();
    for (const RegionColumn& region : columns) {
      const int above = CountRowsAbove(view, region, plane, options.max_height);
      object.columns.push_back(
          {region.column, region.rows.front() - above, region.rows.back(), region.distance});
    }
  }
  return objects;
}

cv::Mat MaskOf(std::span<const MovingObject> objects, cv::Size size) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8U);
  for (const MovingObject& object : objects) {
    for (const MovingObject::Column& column : object.columns) {
      mask(cv::Rect(column.column, column.top, 1, column.bottom + 1 - column.top)) = 255;
    }
  }
  return mask;
}

void PlaceOnGround(std::span<const MovingObject> objects, const DenseGround& ground,
                   const MovingObjectOptions& options, DenseDepth* depth) {
  const EquirectangularCamera camera(depth->range.cols, depth->range.rows);
  const auto confidence = static_cast<float>(1 / (1 + options.stated_error));
  if (depth->source.empty()) depth->source = cv::Mat::zeros(depth->range.size(), CV_8U);
  for (const MovingObject& object : objects) {
    for (const MovingObject::Column& column : object.columns) {
      for (int row = column.top; row <= column.bottom; ++row) {
        const double fall = ground.up.dot(camera.Bearing({column.column + 0.5, row + 0.5}));
        depth->range.at<float>(row, column.column) =
            static_cast<float>(column.distance / std::sqrt(1 - fall * fall));
        depth->confidence.at<float>(row, column.column) = confidence;
        depth->source.at<std::uint8_t>(row, column.column) =
            static_cast<std::uint8_t>(RangeSource::kMovingObject);
      }
    }
  }
}

}  // namespace orb360
