#include "slam/depth/surface_confirmation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Cholesky>

#include "nn/base/check.h"

namespace orb360 {
namespace {

/// A surface seen at less than this sine of the angle is treated as if seen at that: its normal is
/// not known better.
constexpr float kMinIncidence = 0.15f;
/// Ranges that differ by this factor belong to different surfaces.
constexpr float kEdgeRatio = 1.15f;
/// Pixels to either side that a plane is fitted to, and the difference in ln(range) from the centre
/// at which a pixel counts half.
constexpr int kPlaneReach = 2;
constexpr float kPlaneScale = 0.15f;

std::vector<Eigen::Vector2f> CosinesAndSines(int count, double first, double step) {
  std::vector<Eigen::Vector2f> result(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double angle = first + step * i;
    result[static_cast<size_t>(i)] =
        Eigen::Vector2d(std::cos(angle), std::sin(angle)).cast<float>();
  }
  return result;
}

Eigen::Vector3f Bearing(const Eigen::Vector2f& longitude, const Eigen::Vector2f& latitude) {
  return {-latitude.x() * longitude.x(), latitude.x() * longitude.y(), latitude.y()};
}

/// Columns between neighbours in a row that are as far apart as rows are at the equator.
int ColumnStep(float cosine_of_latitude) {
  return std::max(1, static_cast<int>(std::lround(1.0f / std::max(cosine_of_latitude, 1e-3f))));
}

/// A column beyond the seam. Loops: division takes longer than everything else around it, and is
/// needed nowhere but at the poles.
int WrapColumn(int column, int width) {
  while (column < 0) column += width;
  while (column >= width) column -= width;
  return column;
}

/// What another keyframe says of a point.
struct Opinion {
  enum { kNone, kSupports, kContradicts } verdict = kNone;
  float offset = 0;       // of its surface from the point, along the normal, world units
  float information = 0;  // 1 / variance of that
};

/// Another keyframe, seen from the one whose points are tested.
struct Witness {
  const DepthView* view;
  Eigen::Matrix3f rotation;  // witness_from_view
  Eigen::Vector3f translation;
};

Opinion Ask(const Witness& witness, const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
            float variance, const ConfirmationOptions& options) {
  const Eigen::Vector3f seen = witness.rotation * point + witness.translation;
  const float range = seen.norm();
  if (!(range > 0)) return {};
  const Eigen::Vector3f bearing = seen / range;
  const DepthView::Sample sample = witness.view->At(bearing);
  if (!(sample.range > 0)) return {};
  const float slant = bearing.dot(witness.rotation * normal);
  const float incidence = std::max(std::abs(slant), kMinIncidence);
  const float error = sample.range * sample.error * incidence;
  const float tolerance =
      static_cast<float>(options.tolerance_errors) * std::sqrt(variance + error * error) +
      static_cast<float>(options.tolerance_share) * range * incidence;
  const float deviation = (sample.range - range) * incidence;
  if (std::abs(deviation) <= tolerance) {
    // A surface turned away from the witness is another one that happens to be there.
    if (slant > kMinIncidence) return {};
    return {Opinion::kSupports, (sample.range - range) * slant, 1.0f / (error * error)};
  }
  if (deviation < 0) return {};
  const float nearest = witness.view->Nearest(sample.row, sample.column);
  if ((nearest - range) * incidence > tolerance) return {Opinion::kContradicts};
  return {};
}

}  // namespace

DepthView::DepthView(const DenseDepth& depth, const Rigid3& world_from_camera, double scale,
                     const ConfirmationOptions& options)
    : world_from_camera_(world_from_camera) {
  ORB360_CHECK(depth.range.type() == CV_32FC1 && depth.confidence.type() == CV_32FC1,
               depth.range.type(), depth.confidence.type());
  ORB360_CHECK(depth.range.size() == depth.confidence.size() && depth.range.rows >= 4 &&
                   depth.range.cols >= 8 && depth.range.cols % 2 == 0,
               depth.range.size(), depth.confidence.size());
  ORB360_CHECK(scale > 0 && std::isfinite(scale), scale);
  depth.range.convertTo(range_, CV_32F, scale);
  confidence_.create(range_.size(), CV_8UC1);
  for (int row = 0; row < height(); ++row) {
    const float* confidence = depth.confidence.ptr<float>(row);
    float* range = range_.ptr<float>(row);
    std::uint8_t* level = confidence_.ptr<std::uint8_t>(row);
    for (int column = 0; column < width(); ++column) {
      level[column] = cv::saturate_cast<std::uint8_t>(255.0f * confidence[column]);
      if (!(range[column] > 0 && level[column] > 0)) range[column] = 0;
    }
  }
  for (size_t level = 0; level < errors_.size(); ++level) {
    errors_[level] = std::max(static_cast<float>(options.min_error),
                              255.0f / std::max(static_cast<float>(level), 0.5f) - 1.0f);
  }
  longitudes_ = CosinesAndSines(width(), -std::numbers::pi + std::numbers::pi / width(),
                                2.0 * std::numbers::pi / width());
  latitudes_ = CosinesAndSines(height(), 0.5 * std::numbers::pi * (1.0 - 1.0 / height()),
                               -std::numbers::pi / height());
}

Eigen::Vector3f DepthView::BearingOf(int row, int column) const {
  return Bearing(longitudes_[static_cast<size_t>(column)], latitudes_[static_cast<size_t>(row)]);
}

float DepthView::Nearest(int row, int column) const {
  float least = range(row, column);
  for (int y = std::max(0, row - 1); y <= std::min(height() - 1, row + 1); ++y) {
    for (const int x : {column - 1, column, column + 1}) {
      least = std::min(least, range(y, WrapColumn(x, width())));
    }
  }
  return least;
}

DepthView::Sample DepthView::At(const Eigen::Vector3f& bearing) const {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float longitude = std::atan2(bearing.y(), -bearing.x());
  const float latitude =
      std::atan2(bearing.z(), std::sqrt(bearing.x() * bearing.x() + bearing.y() * bearing.y()));
  // In pixels whose centres are at integers.
  const float u = (longitude / (2.0f * kPi) + 0.5f) * static_cast<float>(width()) - 0.5f;
  const float v = (0.5f - latitude / kPi) * static_cast<float>(height()) - 0.5f;
  const int left = static_cast<int>(std::floor(u));
  const int top = static_cast<int>(std::floor(v));
  const float right_share = u - static_cast<float>(left);
  const float bottom_share = v - static_cast<float>(top);
  // Beyond a pole the first or last row goes on at the opposite longitude.
  const auto range_at = [this](int row, int column) {
    const bool is_beyond = row < 0 || row >= height();
    const int x = column + (is_beyond ? width() / 2 : 0);
    return range(std::clamp(row, 0, height() - 1), WrapColumn(x, width()));
  };
  const float corners[4] = {range_at(top, left), range_at(top, left + 1), range_at(top + 1, left),
                            range_at(top + 1, left + 1)};
  const int row = std::clamp(bottom_share < 0.5f ? top : top + 1, 0, height() - 1);
  const int column = WrapColumn(right_share < 0.5f ? left : left + 1, width());
  Sample sample{range(row, column), error(row, column), row, column};
  const auto [least, most] = std::minmax({corners[0], corners[1], corners[2], corners[3]});
  if (least > 0 && most < kEdgeRatio * least) {
    const float above = (1.0f - right_share) / corners[0] + right_share / corners[1];
    const float below = (1.0f - right_share) / corners[2] + right_share / corners[3];
    sample.range = 1.0f / ((1.0f - bottom_share) * above + bottom_share * below);
  }
  return sample;
}

Eigen::Vector3f DepthView::Normal(int row, int column) const {
  // The plane m . p = 1 has 1 / range = m . bearing: linear least squares.
  const float centre = range(row, column);
  if (!(centre > 0)) return Eigen::Vector3f::Zero();
  Eigen::Matrix3f system = Eigen::Matrix3f::Zero();
  Eigen::Vector3f right = Eigen::Vector3f::Zero();
  for (int y = std::max(0, row - kPlaneReach); y <= std::min(height() - 1, row + kPlaneReach);
       ++y) {
    const int step = ColumnStep(latitudes_[static_cast<size_t>(y)].x());
    for (int i = -kPlaneReach; i <= kPlaneReach; ++i) {
      const int x = WrapColumn(column + i * step, width());
      const float other = range(y, x);
      if (!(other > 0)) continue;
      const float inverse = centre / other;  // In units of the centre's, for the sake of rounding.
      const float difference = (inverse - 1.0f) / kPlaneScale;
      const float weight = 1.0f / (1.0f + difference * difference);
      const Eigen::Vector3f bearing = BearingOf(y, x);
      system += weight * bearing * bearing.transpose();
      right += weight * inverse * bearing;
    }
  }
  // Within few pixels bearings are nearly the same: what they leave open is taken to be zero.
  const float ridge = 1e-7f * system.trace();
  system.diagonal().array() += ridge;
  const Eigen::Vector3f plane =
      system.cast<double>().ldlt().solve(right.cast<double>()).cast<float>();
  const float length = plane.norm();
  if (!(length > 0) || !std::isfinite(length)) return Eigen::Vector3f::Zero();
  return plane.dot(BearingOf(row, column)) > 0 ? Eigen::Vector3f(-plane / length)
                                               : Eigen::Vector3f(plane / length);
}

std::vector<ConfirmedPoint> ConfirmSurface(const DepthView& view,
                                           std::span<const DepthView* const> others,
                                           const ConfirmationOptions& options,
                                           const SamplingOptions& sampling) {
  ORB360_CHECK(sampling.spacing > 0, sampling.spacing);
  const Rigid3& world_from_view = view.world_from_camera();
  std::vector<Witness> witnesses;
  for (const DepthView* other : others) {
    const Rigid3 other_from_view = other->world_from_camera().Inverse() * world_from_view;
    witnesses.push_back({other, other_from_view.rotation.toRotationMatrix().cast<float>(),
                         other_from_view.translation.cast<float>()});
  }
  const float pixel_angle = std::numbers::pi_v<float> / static_cast<float>(view.height());
  // A point keeps at least this share of its own error: others may be better than it by the one
  // factor (in variance), and all together better than the best by the other.
  const auto least_gain = static_cast<float>(1 / std::sqrt(std::max(options.redundant_ratio, 1.0) *
                                                           std::max(options.max_independent, 1.0)));
  const float max_own_error = static_cast<float>(sampling.max_error) / least_gain;
  const double max_conflict = options.max_conflict_share * static_cast<double>(witnesses.size());

  // The point of a pixel, where it is confirmed.
  const auto confirm = [&](int row, int column, const Eigen::Vector3f& bearing,
                           float range) -> std::optional<ConfirmedPoint> {
    const float largest_error = range * view.error(row, column);
    if (largest_error * kMinIncidence > max_own_error) return std::nullopt;
    const Eigen::Vector3f normal = view.Normal(row, column);
    if (normal.isZero()) return std::nullopt;
    const float incidence = std::max(-normal.dot(bearing), kMinIncidence);
    const float own_error = largest_error * incidence;
    if (own_error > max_own_error) return std::nullopt;
    const float own_information = 1.0f / (own_error * own_error);
    float information = own_information;
    float best = information;
    float shift = 0;
    int support = 0;
    int conflict = 0;
    for (const Witness& witness : witnesses) {
      const Opinion opinion = Ask(witness, range * bearing, normal, own_error * own_error, options);
      if (opinion.verdict == Opinion::kContradicts && ++conflict > max_conflict) {
        return std::nullopt;
      }
      if (opinion.verdict != Opinion::kSupports) continue;
      if (opinion.information > options.redundant_ratio * own_information) return std::nullopt;
      ++support;
      information += opinion.information;
      shift += opinion.information * opinion.offset;
      best = std::max(best, opinion.information);
    }
    if (support < options.min_support) return std::nullopt;
    if (conflict > options.max_conflict_share * (support + conflict)) return std::nullopt;
    const float error =
        1.0f / std::sqrt(std::min(information, static_cast<float>(options.max_independent) * best));
    if (error > sampling.max_error) return std::nullopt;
    const Eigen::Vector3f point = range * bearing + shift / information * normal;
    return ConfirmedPoint{world_from_view * point.cast<double>(),
                          (world_from_view.rotation * normal.cast<double>()).cast<float>(), error,
                          row, column};
  };

  std::vector<std::vector<ConfirmedPoint>> rows(static_cast<size_t>(view.height()));
#pragma omp parallel for schedule(dynamic, 8)
  for (int row = 0; row < view.height(); ++row) {
    const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / view.height());
    const int step = ColumnStep(static_cast<float>(std::cos(latitude)));
    for (int column = 0; column < view.width(); column += step) {
      const float range = view.range(row, column);
      if (!(range > 0) || range > sampling.max_range) continue;
      // The largest power of two at which pixels are no farther apart than the spacing.
      int stride = 1;
      while (2.0f * static_cast<float>(stride) * range * pixel_angle <= sampling.spacing) {
        stride *= 2;
      }
      if (row % stride != 0 || column / step % stride != 0) continue;
      const Eigen::Vector3f bearing = view.BearingOf(row, column);
      if (std::optional<ConfirmedPoint> point = confirm(row, column, bearing, range)) {
        rows[static_cast<size_t>(row)].push_back(*point);
      }
    }
  }
  std::vector<ConfirmedPoint> points;
  for (const std::vector<ConfirmedPoint>& row : rows) {
    points.insert(points.end(), row.begin(), row.end());
  }
  return points;
}

}  // namespace orb360
