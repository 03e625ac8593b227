#include "slam/depth/occluding_boundary.h"

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>

namespace orb360 {

cv::Mat FindOccludingBoundary(const cv::Mat& range, const OccludingBoundaryOptions& options) {
  ORB360_CHECK(range.type() == CV_32FC1, range.type());
  ORB360_CHECK(options.width > 0 && options.width < range.cols, options.width, range.cols);
  const int side = 2 * options.width + 1;
  cv::Mat wrapped;  // Longitude continues at the other side of the image.
  cv::copyMakeBorder(range, wrapped, 0, 0, options.width, options.width, cv::BORDER_WRAP);
  cv::Mat farthest;
  cv::dilate(wrapped, farthest, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  farthest = farthest.colRange(options.width, options.width + range.cols);
  cv::Mat boundary = farthest > options.min_ratio * range;
  boundary.setTo(0, ~(range > 0));
  return boundary;
}

}  // namespace orb360
