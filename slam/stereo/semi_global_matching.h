#pragma once

#include <opencv2/core.hpp>

#include "slam/stereo/disparity_search.h"
#include "slam/stereo/speckles.h"

namespace orb360 {

struct SemiGlobalMatchingOptions {
  DisparityPenalties penalties;
  /// Number of finest levels that are not searched: the disparities of the level above are
  /// interpolated there, and refined afterwards (RefineDisparities). Windows of a coarser level see
  /// more of a surface with little texture, and a level has four times the pixels of the one above.
  int num_skipped_levels = 1;
  /// Least ratio of the costs of the second-best disparity and of the best one.
  double min_uniqueness = 1.05;
  /// Largest difference of the disparities of both views, pixels.
  int max_difference = 1;
  /// Largest mean cost of the disparities within 5 x 5 pixels, bits; 12 are those of noise.
  double max_cost = 7.5;
  /// Least mean difference along the row within 5 x 5 pixels, gray levels over two pixels. Less is
  /// the noise of a surface without texture, whose disparity would be that of its border.
  double min_gradient = 1.0;
  SpeckleOptions speckles;
};

/// Width of the coarsest level, pixels. It is searched for disparities up to half of it. Each level
/// is half as large as the one below.
inline constexpr int kCoarsestStereoWidth = 64;

/// Disparities of two rectified spheres (RectifySphere; CV_8U of equal size): column in the second
/// image less column in the first one, pixels, never negative. CV_32F; negative where unknown.
///
/// Semi-global matching of census transforms (Hirschmueller, PAMI 2008), coarse to fine (Rothermel
/// et al., LC3D 2012). On each level the second image is warped by the surface that the level above
/// has found, and disparities of -8 to 7 pixels from it are searched. Windows and penalties thereby
/// follow the surface (Scharstein, Taniai, Sinha, 3DV 2017): on the ground below a camera the
/// disparity changes by more than a pixel from pixel to pixel.
///
/// `hypothesis` (may be empty): the disparities of a surface that may be there, CV_32F; negative
/// where there is none. The finest level is searched around it as well, and what costs less is
/// taken. Levels above may have missed it, where its texture is too fine for them, and then a
/// regular texture matches at a wrong place.
///
/// Throws ContractError unless the width is kCoarsestStereoWidth times a power of two and the
/// hypothesis as large as the level that is searched last, SearchedWidth.
cv::Mat MatchSemiGlobally(const cv::Mat& first, const cv::Mat& second,
                          const SemiGlobalMatchingOptions& options, const cv::Mat& hypothesis = {});

/// Width of the finest level that is searched for images of this width, pixels.
int SearchedWidth(int width, const SemiGlobalMatchingOptions& options);

}  // namespace orb360
