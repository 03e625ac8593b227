#include "slam/depth/depth_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/depth/fusion_confidence.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

std::vector<Eigen::Vector2f> CosinesAndSines(int count, double first, double step) {
  std::vector<Eigen::Vector2f> result(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double angle = first + step * i;
    result[static_cast<size_t>(i)] =
        Eigen::Vector2d(std::cos(angle), std::sin(angle)).cast<float>();
  }
  return result;
}

}  // namespace

int ColumnStep(double cosine_of_latitude) {
  return std::max(1, static_cast<int>(std::lround(1.0 / std::max(cosine_of_latitude, 1e-3))));
}

DepthView::DepthView(const DenseDepth& depth, const Rigid3& world_from_camera, double min_error)
    : width_(depth.range.cols),
      height_(depth.range.rows),
      world_from_camera_(world_from_camera),
      min_error_(static_cast<float>(min_error)) {
  ORB360_CHECK(depth.range.type() == CV_32FC1 && depth.confidence.type() == CV_32FC1,
               depth.range.type(), depth.confidence.type());
  ORB360_CHECK(depth.range.size() == depth.confidence.size() && depth.range.rows >= 4 &&
                   depth.range.cols >= 8 && depth.range.cols % 2 == 0,
               depth.range.size(), depth.confidence.size());
  ORB360_CHECK(min_error > 0, min_error);
  const cv::Mat confidences = FusionConfidence(depth);
  inverse_ranges_.assign(depth.range.total(), 0.0f);
  levels_.assign((depth.range.total() + 3) / 4, 0);
  size_t index = 0;
  for (int row = 0; row < height(); ++row) {
    const float* range = depth.range.ptr<float>(row);
    const float* confidence = confidences.ptr<float>(row);
    for (int column = 0; column < width(); ++column, ++index) {
      const auto level = cv::saturate_cast<std::uint8_t>(255.0f * confidence[column]);
      const float inverse = 1.0f / range[column];
      if (!(inverse > 0 && std::isfinite(inverse) && level > 0)) continue;
      inverse_ranges_[index] = inverse;
      levels_[index / 4] |= std::uint32_t{level} << (8 * (index % 4));
    }
  }
  for (size_t level = 0; level < errors_.size(); ++level) {
    errors_[level] =
        std::max(min_error_, 255.0f / std::max(static_cast<float>(level), 0.5f) - 1.0f);
  }
  longitudes_ = CosinesAndSines(width(), -std::numbers::pi + std::numbers::pi / width(),
                                2.0 * std::numbers::pi / width());
  latitudes_ = CosinesAndSines(height(), 0.5 * std::numbers::pi * (1.0 - 1.0 / height()),
                               -std::numbers::pi / height());
}

}  // namespace orb360
