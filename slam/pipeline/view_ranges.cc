#include "slam/pipeline/view_ranges.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/depth/fusion_confidence.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

float ConfidenceOf(float relative_error) { return 1.0F / (1.0F + relative_error); }

constexpr auto kMeasured = static_cast<std::uint8_t>(RangeSource::kMeasured);

void RequireSources(const DenseDepth& depth) {
  ORB360_CHECK(depth.source.type() == CV_8UC1 && depth.source.size() == depth.range.size(),
               depth.source.type(), depth.source.size(), depth.range.size());
}

}  // namespace

void StateCompleted(double factor, DenseDepth* depth) {
  for (int row = 0; row < depth->confidence.rows; ++row) {
    for (int column = 0; column < depth->confidence.cols; ++column) {
      auto& confidence = depth->confidence.at<float>(row, column);
      if (!(confidence > 0)) continue;
      confidence = ConfidenceOf(static_cast<float>(factor) * (1 / confidence - 1));
    }
  }
  depth->source.create(depth->range.size(), CV_8U);
  depth->source.setTo(static_cast<double>(RangeSource::kCompleted));
}

void PutMeasured(const InverseRanges& measured, DenseDepth* depth) {
  RequireSources(*depth);
  for (int row = 0; row < measured.value.rows; ++row) {
    for (int column = 0; column < measured.value.cols; ++column) {
      const float value = measured.value.at<float>(row, column);
      if (!(value > 0)) continue;
      depth->range.at<float>(row, column) = 1 / value;
      depth->confidence.at<float>(row, column) =
          ConfidenceOf(measured.sigma.at<float>(row, column) / value);
      depth->source.at<std::uint8_t>(row, column) = kMeasured;
    }
  }
}

void StateBoundary(const cv::Mat& mask, double least_error, DenseDepth* depth) {
  RequireSources(*depth);
  cv::Mat limited;
  cv::min(depth->confidence, ConfidenceOf(static_cast<float>(least_error)), limited);
  limited.copyTo(depth->confidence, mask);
  depth->source.setTo(static_cast<double>(RangeSource::kBoundary), mask);
}

InverseRanges MeasuredOf(const DenseDepth& depth) {
  RequireSources(depth);
  InverseRanges measured{cv::Mat::zeros(depth.range.size(), CV_32F),
                         cv::Mat::zeros(depth.range.size(), CV_32F)};
  for (int row = 0; row < depth.range.rows; ++row) {
    for (int column = 0; column < depth.range.cols; ++column) {
      const float range = depth.range.at<float>(row, column);
      const float confidence = depth.confidence.at<float>(row, column);
      if (!(range > 0) || depth.source.at<std::uint8_t>(row, column) != kMeasured) continue;
      measured.value.at<float>(row, column) = 1 / range;
      measured.sigma.at<float>(row, column) = (1 / confidence - 1) / range;
    }
  }
  return measured;
}

double TrustedRange(const DenseDepth& depth, double min_confidence) {
  cv::Mat trusted = depth.range.clone();
  trusted.setTo(0, ~(FusionConfidence(depth) >= min_confidence));
  const double range = MedianRange(trusted);
  return range > 0 ? range : MedianRange(depth.range);
}

bool SampleSquares(const InverseRanges& measured, int side, double min_fraction,
                   const SparseDepthOptions& options, SparseDepth* sparse) {
  const cv::Size size = measured.value.size();
  int num_squares = 0;
  std::vector<cv::Point> chosen;
  for (int top = 0; top < size.height; top += side) {
    for (int left = 0; left < size.width; left += side) {
      ++num_squares;
      for (int i = 0; i < side * side; ++i) {
        const int at = (i + side * side / 2) % (side * side);
        const int row = top + at / side;
        const int column = left + at % side;
        if (row >= size.height || column >= size.width) continue;
        if (!(measured.value.at<float>(row, column) > 0)) continue;
        chosen.emplace_back(column, row);
        break;
      }
    }
  }
  if (static_cast<double>(chosen.size()) < min_fraction * num_squares) return false;
  for (const cv::Point& pixel : chosen) {
    const cv::Rect square =
        cv::Rect(pixel.x / side * side, pixel.y / side * side, side, side) & cv::Rect({}, size);
    sparse->range(square) = 0;
    sparse->confidence(square) = 0;
    const float value = measured.value.at<float>(pixel);
    sparse->range.at<float>(pixel) = 1 / value;
    sparse->confidence.at<float>(pixel) =
        static_cast<float>(SparseConfidence(measured.sigma.at<float>(pixel) / value, options));
  }
  return true;
}

}  // namespace orb360
