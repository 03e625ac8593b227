#pragma once

#include <opencv2/core.hpp>

#include "slam/stereo/inverse_ranges.h"
#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/depth/sparse_depth.h>

namespace orb360 {

/// Says of ranges of the network that they are completed ones (RangeSource::kCompleted), and
/// multiplies the errors that it expects by `factor`.
void StateCompleted(double factor, DenseDepth* depth);

/// Puts ranges that stereo measured in the place of others. Contract: the depth has sources.
void PutMeasured(const InverseRanges& measured, DenseDepth* depth);

/// Says of the ranges where `mask` (CV_8U) is not 0 that they are at boundaries, with an expected
/// error of at least `least_error`. Contract: the depth has sources.
void StateBoundary(const cv::Mat& mask, double least_error, DenseDepth* depth);

/// Returns the measured ranges of the depth of a view. Contract: it has sources.
InverseRanges MeasuredOf(const DenseDepth& depth);

/// Puts one measured range of each square of `side` pixels that has any into the sparse depth, in
/// the place of what that has in the square: the first one by rows from the middle on. False,
/// without a change, where less than `min_fraction` of the squares have one.
bool SampleSquares(const InverseRanges& measured, int side, double min_fraction,
                   const SparseDepthOptions& options, SparseDepth* sparse);

/// Returns the median of the ranges with at least that FusionConfidence, weighted by solid angle,
/// or of all where none has it; 0 without any. The network gives the sky ranges too, with little
/// confidence.
double TrustedRange(const DenseDepth& depth, double min_confidence);

}  // namespace orb360
