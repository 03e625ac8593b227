#include "slam/depth/reprojected_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// What another view measured, in a square of this one.
struct Candidate {
  int square;
  int view;
  cv::Point pixel;
  float range;
  float relative_error;
  cv::Vec3f difference;  ///< Of the logarithms of the colours, other minus this.
};

/// ln of a value of SurfaceColors; dark ones are mostly noise.
float LogOf(std::uint8_t value) { return std::log(static_cast<float>(value) + 4.0F); }

cv::Vec3f Difference(const cv::Vec3b& other, const cv::Vec3b& own) {
  cv::Vec3f difference;
  for (int i = 0; i < 3; ++i) difference[i] = LogOf(other[i]) - LogOf(own[i]);
  return difference;
}

std::vector<Candidate> Project(const SeenView& seen, int index, const Rigid3& world_from_camera,
                               const cv::Mat& colors, const EquirectangularCamera& camera,
                               int squares_across, const ReprojectionOptions& options) {
  const DepthView& other = *seen.depth;
  const Rigid3 camera_from_other = world_from_camera.Inverse() * other.world_from_camera();
  std::vector<Candidate> candidates;
  for (int row = options.step / 2; row < other.height(); row += options.step) {
    const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / other.height());
    const int across = options.step * ColumnStep(std::cos(latitude));
    for (int column = 0; column < other.width(); column += across) {
      const float range = other.range(row, column);
      if (!(range > 0) || other.error(row, column) > options.max_error) continue;
      const Eigen::Vector3d point =
          camera_from_other *
          Eigen::Vector3d((range * other.BearingOf(row, column)).cast<double>());
      const double distance = point.norm();
      if (!(distance > 0)) continue;
      const Eigen::Vector2d at = camera.Project(point);
      const cv::Point pixel(std::clamp(static_cast<int>(at.x()), 0, camera.width() - 1),
                            std::clamp(static_cast<int>(at.y()), 0, camera.height() - 1));
      candidates.push_back(
          {pixel.y / options.spacing * squares_across + pixel.x / options.spacing, index, pixel,
           static_cast<float>(distance),
           static_cast<float>(range * other.error(row, column) / distance),
           Difference(seen.colors->at<cv::Vec3b>(row, column), colors.at<cv::Vec3b>(pixel))});
    }
  }
  // What most surfaces differ by is a difference of exposure.
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<float> all;
    all.reserve(candidates.size());
    for (const Candidate& candidate : candidates) all.push_back(candidate.difference[channel]);
    if (all.empty()) break;
    const float exposure = Median(all);
    for (Candidate& candidate : candidates) candidate.difference[channel] -= exposure;
  }
  const auto looks_different = [&](const Candidate& candidate) {
    return cv::norm(candidate.difference, cv::NORM_INF) > options.max_color_difference;
  };
  std::erase_if(candidates, looks_different);
  return candidates;
}

/// The nearest one on which two views agree. They are ordered by range.
std::optional<Candidate> NearestAgreed(std::span<const Candidate> candidates, double max_ratio) {
  for (size_t i = 0; i < candidates.size(); ++i) {
    for (size_t j = i + 1; j < candidates.size(); ++j) {
      if (candidates[j].range > max_ratio * candidates[i].range) break;
      if (candidates[j].view != candidates[i].view) return candidates[i];
    }
  }
  return std::nullopt;
}

/// The nearest range of each square, and infinity where it has no point.
cv::Mat NearestOfSquares(const cv::Mat& range, int spacing) {
  cv::Mat nearest((range.rows + spacing - 1) / spacing, (range.cols + spacing - 1) / spacing,
                  CV_32F, cv::Scalar(std::numeric_limits<float>::infinity()));
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const float value = range.at<float>(row, column);
      float& least = nearest.at<float>(row / spacing, column / spacing);
      if (value > 0) least = std::min(least, value);
    }
  }
  return nearest;
}

}  // namespace

cv::Mat SurfaceColors(const cv::Mat& image, cv::Size size) {
  cv::Mat colors;
  cv::resize(image, colors, size, 0, 0, cv::INTER_AREA);
  constexpr int kReach = 2;
  cv::Mat wide;
  cv::copyMakeBorder(colors, wide, 0, 0, kReach, kReach, cv::BORDER_WRAP);
  cv::GaussianBlur(wide, wide, {2 * kReach + 1, 2 * kReach + 1}, 0);
  return wide.colRange(kReach, kReach + size.width).clone();
}

void AddReprojectedPoints(const Rigid3& world_from_camera, const cv::Mat& colors,
                          std::span<const SeenView> others, const ReprojectionOptions& options,
                          SparseDepth* sparse, int num_threads) {
  ORB360_CHECK(options.spacing > 0 && options.step > 0, options.spacing, options.step);
  ORB360_CHECK(colors.type() == CV_8UC3 && colors.size() == sparse->range.size(), colors.type(),
               colors.size());
  for (const SeenView& other : others) {
    ORB360_CHECK(other.colors->type() == CV_8UC3 &&
                     other.colors->size() == cv::Size(other.depth->width(), other.depth->height()),
                 other.colors->type(), other.colors->size());
  }
  const EquirectangularCamera camera(sparse->range.cols, sparse->range.rows);
  const cv::Mat own = NearestOfSquares(sparse->range, options.spacing);
  cv::Mat around;  // The nearest within two squares.
  cv::erode(own, around, cv::Mat::ones(5, 5, CV_8U));
  const auto count = static_cast<int>(others.size());
  std::vector<std::vector<Candidate>> projected(others.size());
#pragma omp parallel for num_threads(num_threads) schedule(dynamic)
  for (int i = 0; i < count; ++i) {
    projected[static_cast<size_t>(i)] = Project(
        others[static_cast<size_t>(i)], i, world_from_camera, colors, camera, own.cols, options);
  }
  std::vector<Candidate> candidates;
  for (const std::vector<Candidate>& of_view : projected) {
    candidates.insert(candidates.end(), of_view.begin(), of_view.end());
  }
  std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
    return std::tuple(a.square, a.range, a.view, a.pixel.y, a.pixel.x) <
           std::tuple(b.square, b.range, b.view, b.pixel.y, b.pixel.x);
  });
  for (size_t begin = 0, end = 0; begin < candidates.size(); begin = end) {
    const int square = candidates[begin].square;
    while (end < candidates.size() && candidates[end].square == square) ++end;
    const cv::Point at(square % own.cols, square / own.cols);
    if (std::isfinite(own.at<float>(at))) continue;
    const std::optional<Candidate> point =
        NearestAgreed(std::span(candidates).subspan(begin, end - begin), options.max_ratio);
    if (!point) continue;
    if (point->range > static_cast<float>(options.max_hidden_ratio) * around.at<float>(at))
      continue;
    const double confidence = SparseConfidence(point->relative_error, options.sparse);
    if (confidence < options.sparse.min_confidence) continue;
    sparse->range.at<float>(point->pixel) = point->range;
    sparse->confidence.at<float>(point->pixel) = static_cast<float>(confidence);
  }
}

}  // namespace orb360
