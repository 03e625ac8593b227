#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

struct OccludingBoundaryOptions {
  /// Distance from the edge up to which a near surface has grown over what lies behind it, pixels.
  int width = 3;
  /// Ratio of ranges from which on two of them belong to different surfaces.
  double min_ratio = 1.2;
};

/// Returns CV_8U, 255 at pixels of which something farther away is seen close by: those along the
/// edges of near surfaces. Window-based stereo gives the range of the near surface to pixels beyond
/// its edge as well, because the edge is the texture that its windows match (foreground fattening;
/// Scharstein, Szeliski 2002), and it does so in every view.
///
/// `range` is CV_32FC1 and equirectangular, infinite in the sky; pixels without a range (0) are
/// left out.
cv::Mat FindOccludingBoundary(const cv::Mat& range, const OccludingBoundaryOptions& options = {});

}  // namespace orb360
