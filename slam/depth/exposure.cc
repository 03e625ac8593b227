#include "slam/depth/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>

#include <Eigen/SparseCholesky>
#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include "slam/depth/fusion_confidence.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

struct Ratio {
  size_t first;
  size_t second;
  Eigen::Array3d log_ratio;  // Of the values of the second view to those of the first.
  double information;
};

struct LoadedView {
  size_t index;
  cv::Mat range;       // CV_32F
  cv::Mat confidence;  // CV_32F: FusionConfidence
  cv::Mat color;       // CV_8UC3, each value the mean of a few pixels.
};

LoadedView Load(size_t index, std::span<const DenseView> views, const DepthLoader& load) {
  constexpr int kWindow = 5;  // pixels
  DenseDepth depth = load(views[index].frame_index);
  cv::Mat color;
  cv::blur(depth.color, color, {kWindow, kWindow});
  return {index, depth.range, FusionConfidence(depth), color};
}

bool IsExposed(const cv::Vec3b& color, const ExposureOptions& options) {
  return std::ranges::all_of(color.val, [&options](std::uint8_t value) {
    return value >= options.min_value && value <= options.max_value;
  });
}

std::optional<Ratio> Compare(const LoadedView& first, const LoadedView& second,
                             std::span<const DenseView> views, const ExposureOptions& options) {
  constexpr float kMinConfidence = 0.8F;
  const EquirectangularCamera camera(first.range.cols, first.range.rows);
  const Rigid3 second_from_first =
      views[second.index].world_from_camera.Inverse() * views[first.index].world_from_camera;
  std::array<std::vector<double>, 3> logarithms;
  for (int row = options.spacing / 2; row < first.range.rows; row += options.spacing) {
    for (int column = options.spacing / 2; column < first.range.cols; column += options.spacing) {
      const float range = first.range.at<float>(row, column);
      const cv::Vec3b& color = first.color.at<cv::Vec3b>(row, column);
      if (!(range > 0) || first.confidence.at<float>(row, column) < kMinConfidence ||
          !IsExposed(color, options)) {
        continue;
      }
      const Eigen::Vector3d point =
          second_from_first * (range * camera.Bearing({column + 0.5, row + 0.5}));
      const Eigen::Vector2d pixel = camera.Project(point.normalized());
      const cv::Point at(std::min(static_cast<int>(pixel.x()), camera.width() - 1),
                         std::min(static_cast<int>(pixel.y()), camera.height() - 1));
      const float other_range = second.range.at<float>(at);
      const cv::Vec3b& other = second.color.at<cv::Vec3b>(at);
      if (!(other_range > 0) ||
          std::abs(std::log(other_range / point.norm())) > options.max_range_difference ||
          !IsExposed(other, options)) {
        continue;
      }
      for (int i = 0; i < 3; ++i) {
        logarithms[i].push_back(std::log(static_cast<double>(other[i]) / color[i]));
      }
    }
  }
  const auto count = static_cast<double>(logarithms[0].size());
  if (count < options.min_common) return std::nullopt;
  Ratio ratio{first.index, second.index, {}, 0};
  for (int i = 0; i < 3; ++i) ratio.log_ratio[i] = Median(logarithms[i]);
  // With few pixels one surface that shines may be most of them.
  constexpr double kMany = 500;
  ratio.information = std::min(1.0, count / kMany) / (options.ratio_sigma * options.ratio_sigma);
  return ratio;
}

// The earlier views that were loaded last and see the same, the newest first.
std::vector<const LoadedView*> EarlierNeighbours(const DenseView& view,
                                                 const std::deque<LoadedView>& loaded, int count) {
  std::vector<const LoadedView*> found;
  for (auto other = loaded.rbegin(); other != loaded.rend(); ++other) {
    if (static_cast<int>(found.size()) == count) break;
    if (std::ranges::find(view.neighbours, other->index) != view.neighbours.end()) {
      found.push_back(&*other);
    }
  }
  return found;
}

}  // namespace

std::vector<Eigen::Array3f> EstimateGains(std::span<const DenseView> views, const DepthLoader& load,
                                          const ExposureOptions& options,
                                          const std::function<void()>& step) {
  ORB360_CHECK(options.spacing > 0 && options.gain_sigma > 0 && options.ratio_sigma > 0,
               options.spacing, options.gain_sigma, options.ratio_sigma);
  constexpr size_t kLoaded = 8;
  std::deque<LoadedView> loaded;
  std::vector<Ratio> ratios;
  for (size_t i = 0; i < views.size(); ++i) {
    if (step) step();
    const LoadedView view = Load(i, views, load);
    for (const LoadedView* other : EarlierNeighbours(views[i], loaded, options.max_neighbours)) {
      if (const auto ratio = Compare(*other, view, views, options)) ratios.push_back(*ratio);
    }
    if (loaded.size() == kLoaded) loaded.pop_front();
    loaded.push_back(view);
  }
  // Normal equations of the logarithms of the gains. Those of the three channels differ on the
  // right-hand side only.
  const auto count = static_cast<Eigen::Index>(views.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    entries.emplace_back(i, i, 1 / (options.gain_sigma * options.gain_sigma));
  }
  for (const Ratio& ratio : ratios) {
    const auto a = static_cast<Eigen::Index>(ratio.first);
    const auto b = static_cast<Eigen::Index>(ratio.second);
    entries.emplace_back(a, a, ratio.information);
    entries.emplace_back(b, b, ratio.information);
    entries.emplace_back(a, b, -ratio.information);
    entries.emplace_back(b, a, -ratio.information);
    const Eigen::RowVector3d weighted = ratio.information * ratio.log_ratio.matrix().transpose();
    right.row(a) += weighted;
    right.row(b) -= weighted;
  }
  Eigen::SparseMatrix<double> normal(count, count);
  normal.setFromTriplets(entries.begin(), entries.end());
  std::vector<Eigen::Array3f> gains(views.size(), Eigen::Array3f::Ones());
  if (count == 0) return gains;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  const Eigen::MatrixXd logarithms = solver.solve(right);
  for (Eigen::Index i = 0; i < count; ++i) {
    gains[static_cast<size_t>(i)] = logarithms.row(i).array().exp().cast<float>();
  }
  return gains;
}

}  // namespace orb360
