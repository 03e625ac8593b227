#include "slam/io/video/frame_converter.h"

#include <optional>

#include "slam/io/video/hdr.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace orb360 {
namespace {

/// The code of libswscale for a matrix that a frame states; nullopt where BT.601 holds.
std::optional<int> MatrixCode(AVColorSpace matrix) {
  switch (matrix) {
    case AVCOL_SPC_BT709:
      return SWS_CS_ITU709;
    case AVCOL_SPC_FCC:
      return SWS_CS_FCC;
    case AVCOL_SPC_SMPTE240M:
      return SWS_CS_SMPTE240M;
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      return SWS_CS_BT2020;
    default:
      return std::nullopt;
  }
}

/// Tells the scaler the frame's matrix and range where they are not what it assumes.
void SetColorSpace(SwsContext* scaler, const AVFrame& frame) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  if (format == nullptr || (format->flags & AV_PIX_FMT_FLAG_RGB) != 0) return;
  const std::optional<int> matrix = MatrixCode(frame.colorspace);
  int* inverse_table = nullptr;
  int* table = nullptr;
  int source_range = 0;
  int target_range = 0;
  int brightness = 0;
  int contrast = 0;
  int saturation = 0;
  if (sws_getColorspaceDetails(scaler, &inverse_table, &source_range, &table, &target_range,
                               &brightness, &contrast, &saturation) < 0) {
    return;
  }
  const int range = frame.color_range == AVCOL_RANGE_JPEG ? 1 : source_range;
  if (!matrix && range == source_range) return;
  sws_setColorspaceDetails(scaler, matrix ? sws_getCoefficients(*matrix) : inverse_table, range,
                           table, target_range, brightness, contrast, saturation);
}

}  // namespace

bool FrameConverter::Prepare(const AVFrame& frame, AVPixelFormat target) {
  if (scaler_ && frame.width == width_ && frame.height == height_ && frame.format == format_ &&
      frame.colorspace == matrix_ && frame.color_range == range_) {
    return true;
  }
  // Chroma is interpolated for tone mapping only: for 8 bits the fast conversion is kept, which
  // recorded results depend on.
  const int flags = target == AV_PIX_FMT_BGR24
                        ? SWS_BICUBIC
                        : SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT;
  scaler_.reset(sws_getContext(frame.width, frame.height, static_cast<AVPixelFormat>(frame.format),
                               frame.width, frame.height, target, flags, nullptr, nullptr,
                               nullptr));
  if (!scaler_) return false;
  SetColorSpace(scaler_.get(), frame);
  width_ = frame.width;
  height_ = frame.height;
  format_ = frame.format;
  matrix_ = frame.colorspace;
  range_ = frame.color_range;
  return true;
}

cv::Mat FrameConverter::ToBgr(const AVFrame& frame) {
  const std::optional<HdrTransfer> hdr = HdrTransferOf(frame.color_trc);
  if (!Prepare(frame, hdr ? AV_PIX_FMT_BGR48LE : AV_PIX_FMT_BGR24)) return {};
  // libswscale leaves out the last columns of a row that is not padded to a multiple of its
  // vectors.
  constexpr int kVectorPixels = 32;
  const int padded = (frame.width + kVectorPixels - 1) / kVectorPixels * kVectorPixels;
  cv::Mat image(frame.height, padded, hdr ? CV_16UC3 : CV_8UC3);
  std::uint8_t* const planes[] = {image.data, nullptr, nullptr, nullptr};
  const int strides[] = {static_cast<int>(image.step), 0, 0, 0};
  if (sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, planes, strides) !=
      frame.height) {
    return {};
  }
  if (padded != frame.width) image = image.colRange(0, frame.width).clone();
  return hdr ? ToneMapped(image, *hdr) : image;
}

}  // namespace orb360
