#pragma once

#include <opencv2/core.hpp>

#include <orb360/slam/depth/dense_depth.h>

namespace orb360 {

/// Least expected error of ln(range) with which a completed range counts in a comparison of views.
/// No measured range has that much (InverseRangeFusionOptions::max_sigma).
inline constexpr double kLeastCompletedError = 0.07;

/// Returns the confidence with which the ranges of a view count where views are compared and fused
/// (CV_32FC1): the stated one, except that
/// - completed ranges count with several times the error that is stated, at least
///   kLeastCompletedError. Views are completed from the same points and err alike, so that their
///   agreement says less than that of measured ranges (docs/results/stereo.md);
/// - ranges at boundaries and of moving objects count with an error of at least 1, so that they
///   neither become points of a cloud nor support or contradict others.
cv::Mat FusionConfidence(const DenseDepth& depth);

}  // namespace orb360
