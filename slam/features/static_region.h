#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

/// Finds what moves with the camera: the car or hand that carries it, and the black areas that
/// stitching leaves. Pictures a fraction of a second apart are compared at low resolution: where
/// there is texture, yet the picture changes much less than that texture would under the motion
/// the rest of the picture shows, something stands still in front of the lens.
///
/// Only below the horizon (by kMaxLatitude): above, what stands still may as well be far away.
/// Black areas are found everywhere.
class StaticRegionDetector {
 public:
  /// Another picture of the same camera, CV_8UC1 or CV_8UC3, any size. Best 0.2 s or more after the
  /// one before.
  void Add(const cv::Mat& image);

  /// Whether enough pictures show enough motion for a judgement.
  bool HasEvidence() const;

  /// CV_8U of the given size: 0 where the camera's carrier or nothing is seen, 255 elsewhere. All
  /// 255 without evidence of motion, but for black areas.
  cv::Mat Mask(cv::Size size) const;

 private:
  cv::Mat ChangePerTexture(cv::Mat* texture) const;

  cv::Mat previous_;  // CV_32F, working size
  cv::Mat change_;    // sums over the pairs
  cv::Mat gradient_;
  cv::Mat brightest_;
  int pairs_ = 0;
};

}  // namespace orb360
