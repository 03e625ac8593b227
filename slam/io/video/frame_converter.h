#pragma once

#include <opencv2/core.hpp>

#include "slam/io/video/libav.h"

namespace orb360 {

/// Converts decoded frames to 8-bit BGR by libswscale. The matrix is that of ITU-R BT.601 and the
/// range that of the pixel format unless the frame states others. Frames with a transfer function
/// of high dynamic range (PQ, HLG) are tone-mapped (hdr.h).
class FrameConverter {
 public:
  /// Returns a new image, CV_8UC3, BGR, of the frame's size; an empty one for a pixel format that
  /// cannot be converted.
  cv::Mat ToBgr(const AVFrame& frame);

 private:
  bool Prepare(const AVFrame& frame, AVPixelFormat target);

  LibavPtr<SwsContext> scaler_;
  // What scaler_ was made for.
  int width_ = 0;
  int height_ = 0;
  int format_ = AV_PIX_FMT_NONE;
  int matrix_ = AVCOL_SPC_UNSPECIFIED;
  int range_ = AVCOL_RANGE_UNSPECIFIED;
};

}  // namespace orb360
