#include "slam/depth/fusion_confidence.h"

#include <algorithm>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Five times what the network expects (docs/results/stereo.md), of which 1.3 times are stated
// (ViewDepthOptions::completed_error_factor).
constexpr float kCompletedErrorFactor = 5 / 1.3F;
constexpr float kUnusableError = 1.0F;

float FusionError(RangeSource source, float error) {
  switch (source) {
    case RangeSource::kCompleted:
      return std::max(kCompletedErrorFactor * error, static_cast<float>(kLeastCompletedError));
    case RangeSource::kBoundary:
    case RangeSource::kMovingObject:
      return std::max(error, kUnusableError);
    case RangeSource::kNetwork:
    case RangeSource::kMeasured:
      break;
  }
  return error;
}

}  // namespace

cv::Mat FusionConfidence(const DenseDepth& depth) {
  if (depth.source.empty()) return depth.confidence;
  ORB360_CHECK(depth.source.type() == CV_8UC1 && depth.source.size() == depth.confidence.size(),
               depth.source.type(), depth.source.size(), depth.confidence.size());
  cv::Mat counted = depth.confidence.clone();
  for (int row = 0; row < counted.rows; ++row) {
    for (int column = 0; column < counted.cols; ++column) {
      auto& confidence = counted.at<float>(row, column);
      const auto source = static_cast<RangeSource>(depth.source.at<std::uint8_t>(row, column));
      if (!(confidence > 0)) continue;
      confidence = 1 / (1 + FusionError(source, 1 / confidence - 1));
    }
  }
  return counted;
}

}  // namespace orb360
