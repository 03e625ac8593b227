#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

struct SpeckleOptions {
  /// Segments of a smaller fraction of the image's pixels are removed; 300 pixels of 512 x 1024.
  double min_fraction = 300.0 / (512 * 1024);
  /// Largest difference between the disparities of neighbours in one segment, pixels.
  float max_difference = 2.0F;
};

/// Sets the disparities (CV_32F, negative where unknown) of small connected segments to -1: wrong
/// ones agree with few of their neighbours (Hirschmueller, PAMI 2008, peak filtering). The first
/// row and the last one are neighbours, as those of a rectified sphere are.
void RemoveSpeckles(const SpeckleOptions& options, cv::Mat* disparity);

}  // namespace orb360
