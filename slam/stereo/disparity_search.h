#pragma once

#include <opencv2/core.hpp>

#include "slam/stereo/census.h"

namespace orb360 {

/// Penalties of semi-global matching for neighbours whose disparities differ by one pixel and by
/// more, in bits of the census transform. Contract: 0 < small <= large <= 39, so that the sum of
/// four paths fits into a byte.
struct DisparityPenalties {
  int small = 6;
  int large = 32;
};

/// Which disparities are searched.
enum class DisparityRange {
  kWide,    ///< 0 to 31 pixels.
  kAround,  ///< -8 to 7 pixels.
};

/// What was found in each pixel of the first image.
struct FoundDisparities {
  cv::Mat disparity;   ///< CV_32F, column in the second image less column in the first, pixels.
  cv::Mat cost;        ///< CV_8U, differing bits at the nearest whole disparity.
  cv::Mat uniqueness;  ///< CV_32F, ratio of the costs of the second-best disparity and of the best.
  /// CV_8U, how far the disparity that the second image finds at this place is from it, pixels; 255
  /// where it finds none.
  cv::Mat difference;
};

/// A path along a closed column begins this many rows ahead, so that its beginning does not matter.
inline constexpr int kPathLead = 32;

/// Semi-global matching of two census transforms (Hirschmueller, PAMI 2008) along four paths: to
/// the right, to the left, down and up. Columns are closed. The result does not depend on the
/// instruction set. Contract: both are as large, and the height is at least kPathLead.
FoundDisparities SearchDisparities(const CensusImage& first, const CensusImage& second,
                                   DisparityRange range, const DisparityPenalties& penalties);

}  // namespace orb360
