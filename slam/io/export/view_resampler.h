#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "slam/io/export/view.h"

namespace orb360 {

/// Makes the images of views from panoramas of one size. It keeps, for each pinhole view, a table
/// of six bytes for each pixel.
class ViewResampler {
 public:
  ViewResampler(cv::Size panorama_size, std::vector<View> views);

  const std::vector<View>& views() const { return views_; }

  /// Returns the image of view `v`, interpolated with cubic weights. That of the panorama shares
  /// its pixels. Several threads may call it at once.
  cv::Mat Resample(const cv::Mat& panorama, size_t v) const;

  /// Returns the nearest pixel for each of the view's, for masks and depth, where a mean would
  /// exist nowhere. The image may be smaller or larger than the panorama.
  cv::Mat ResampleNearest(const cv::Mat& image, size_t v) const;

 private:
  const cv::Size size_;
  const std::vector<View> views_;
  std::vector<cv::Mat> coordinates_;  // CV_16SC2, integer pixels of the padded panorama
  std::vector<cv::Mat> fractions_;    // CV_16UC1, of OpenCV's fixed point
};

}  // namespace orb360
