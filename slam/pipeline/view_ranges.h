#pragma once

#include <opencv2/core.hpp>

#include "slam/stereo/inverse_ranges.h"
#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/depth/sparse_depth.h>

namespace orb360 {

// The depth of a view has ranges that stereo measured and ranges that the network completed. Their
// errors tell them apart: those of measured ranges are at most
// InverseRangeFusionOptions::max_sigma, those of completed ones at least kLeastCompletedError.

/// Largest expected error of ln(range) of a measured pixel, after its confidence has been rounded
/// to 1/255, and the least one that is stated for a completed pixel.
inline constexpr double kLargestMeasuredError = 0.0625;
inline constexpr double kLeastCompletedError = 0.07;

/// Multiplies the errors that the network expects by `factor`; none is less than
/// kLeastCompletedError.
void Distrust(double factor, DenseDepth* completed);

/// Puts ranges that stereo measured in the place of completed ones.
void PutMeasured(const InverseRanges& measured, DenseDepth* depth);

/// States an expected error of at least `least_error` where `mask` (CV_8U) is not 0.
void LimitConfidence(const cv::Mat& mask, double least_error, DenseDepth* depth);

/// Returns the measured ranges of the depth of a view.
InverseRanges MeasuredOf(const DenseDepth& depth);

/// Puts one measured range of each square of `side` pixels that has any into the sparse depth, in
/// the place of what that has in the square: the first one by rows from the middle on. False,
/// without a change, where less than `min_fraction` of the squares have one.
bool SampleSquares(const InverseRanges& measured, int side, double min_fraction,
                   const SparseDepthOptions& options, SparseDepth* sparse);

/// Returns the median of the ranges with at least that confidence, weighted by solid angle, or of
/// all where none has it; 0 without any. The network gives the sky ranges too, with little
/// confidence.
double TrustedRange(const DenseDepth& depth, double min_confidence);

}  // namespace orb360
