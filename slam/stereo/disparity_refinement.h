#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

struct DisparityRefinementOptions {
  /// Number of Gauss-Newton steps, and the largest change of a disparity in one, pixels.
  int num_steps = 2;
  double max_step = 0.5;
  /// Largest difference from a pixel's disparity of those of its neighbours with which it is
  /// averaged before each step, pixels. A step moves all pixels of a window alike and would leave
  /// the differences that rounding has made.
  double max_difference = 1.0;
  /// Standard deviation of a gray value, levels, in addition to what a window shows.
  double gray_sigma = 2.0;
};

/// Disparities and their standard deviations, pixels, CV_32F; negative where unknown.
struct RefinedDisparities {
  cv::Mat disparity;
  cv::Mat sigma;
};

/// Refines disparities to fractions of a pixel (Lucas, Kanade, IJCAI 1981): the second image is
/// warped by them, and what is left between the images in a window of 5 x 5 pixels, divided by the
/// gradient, is their error. The windows follow the surface, since each pixel is warped by its own
/// disparity, and their mean gray values are made equal. Rows are closed. `first`, `second`: CV_8U;
/// `disparity`: CV_32F, negative where unknown.
RefinedDisparities RefineDisparities(const cv::Mat& first, const cv::Mat& second,
                                     const cv::Mat& disparity,
                                     const DisparityRefinementOptions& options);

}  // namespace orb360
