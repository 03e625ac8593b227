#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

struct SemiGlobalMatchingOptions {
  /// Number of levels, each of half the size of the one below.
  int num_levels = 4;
  /// Penalties for a disparity that leaves the surface of the level above by one pixel more or less
  /// than its neighbour's, and for any larger step, in bits of the census transform.
  int small_penalty = 6;
  int large_penalty = 32;
  /// Least ratio of the costs of the second-best disparity and of the best one.
  double min_uniqueness = 1.05;
  /// Largest difference of the disparities of both views, pixels.
  int max_difference = 1;
  /// Largest mean cost of the disparities within 5 x 5 pixels, bits; 12 are those of noise.
  double max_cost = 6.5;
  /// Least mean difference along the row within 5 x 5 pixels, gray levels over two pixels. Less is
  /// the noise of a surface without texture, whose disparity would be that of its border.
  double min_gradient = 3.0;
};

/// Width of the coarsest level, pixels. It is searched for disparities up to half of it.
inline constexpr int kCoarsestStereoWidth = 64;

/// Disparities of two rectified spheres (RectifySphere; CV_8U of equal size): column in the second
/// image less column in the first one, pixels, never negative. CV_32F; negative where unknown.
///
/// Semi-global matching of census transforms (Hirschmueller, PAMI 2008) along four paths, coarse to
/// fine: each level searches 16 disparities around what the level above has found (Rothermel et
/// al., LC3D 2012). Neighbours are penalized for leaving that surface, not for unequal disparities
/// (Scharstein, Taniai, Sinha, 3DV 2017), because on the ground below a camera the disparity
/// changes by more than a pixel from pixel to pixel. The result does not depend on the number of
/// threads.
///
/// Throws ContractError unless the width is kCoarsestStereoWidth times 2^(num_levels - 1).
cv::Mat MatchSemiGlobally(const cv::Mat& first, const cv::Mat& second,
                          const SemiGlobalMatchingOptions& options, int num_threads = 1);

}  // namespace orb360
