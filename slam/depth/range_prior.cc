#include "slam/depth/range_prior.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

// Largest ratio between the range of a pixel and those around it on one surface. In images 1024
// pixels wide a road reaches it at a distance of 18 heights of the camera.
constexpr float kEdgeRatio = 1.25F;
// Largest useful error of ln(range). A less certain range does not restrict the search.
constexpr double kLargestError = 0.5;
// Least standard deviation. The errors of images of one place are correlated, which the confidence
// of a single one does not state.
constexpr double kLeastSigma = 0.05;

RangePrior PriorAt(const DenseDepth& depth, int row, int column) {
  float nearest = depth.range.at<float>(row, column);
  float farthest = nearest;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, depth.range.rows - 1); ++y) {
    for (int x = column - 1; x <= column + 1; ++x) {
      const int wrapped = (x + depth.range.cols) % depth.range.cols;
      nearest = std::min(nearest, depth.range.at<float>(y, wrapped));
      farthest = std::max(farthest, depth.range.at<float>(y, wrapped));
    }
  }
  const double confidence = depth.confidence.at<float>(row, column);
  const double error = 1 / std::max(confidence, 1e-6) - 1;
  if (!(nearest > 0) || farthest > kEdgeRatio * nearest || error > kLargestError) return {};
  // The confidence states the mean absolute error; the factor is that of Laplace's distribution.
  const double sigma = std::max(std::numbers::sqrt2 * error, kLeastSigma);
  return {depth.range.at<float>(row, column), static_cast<float>(sigma)};
}

}  // namespace

std::vector<RangePrior> SampleRangePriors(const DenseDepth& depth, const Features& features,
                                          std::span<const LandmarkId> landmarks) {
  ORB360_CHECK(std::ssize(landmarks) == features.size(), landmarks.size(), features.size());
  const EquirectangularCamera camera(depth.range.cols, depth.range.rows);
  std::vector<RangePrior> priors(landmarks.size());
  for (size_t f = 0; f < landmarks.size(); ++f) {
    if (landmarks[f] != kNoId) continue;
    const Eigen::Vector2d pixel = camera.Project(features.bearings[f]);
    const int column = static_cast<int>(pixel.x()) % camera.width();
    const int row = std::min(static_cast<int>(pixel.y()), camera.height() - 1);
    priors[f] = PriorAt(depth, row, column);
  }
  return priors;
}

}  // namespace orb360
