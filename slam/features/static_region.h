#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

/// Finds what moves with the camera: the car or hand that carries it, and the black areas that
/// stitching leaves. Images a fraction of a second apart are compared at low resolution. Where
/// there is texture, but the image changes much less than that texture would under the motion of
/// the rest of the image, an object stands still in front of the lens.
///
/// Static regions are found only below the horizon (by kMaxLatitude), because above it they may as
/// well be far away. Black areas are found everywhere.
class StaticRegionDetector {
 public:
  /// Adds an image of the same camera, CV_8UC1 or CV_8UC3, of any size. It should be taken 0.2 s or
  /// more after the previous one.
  void Add(const cv::Mat& image);

  /// Returns true if enough images show enough motion for a decision.
  bool HasEvidence() const;

  /// Returns a mask, CV_8U of the given size: 0 where the camera's carrier or nothing is seen, 255
  /// elsewhere. Without evidence of motion only black areas are 0.
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
