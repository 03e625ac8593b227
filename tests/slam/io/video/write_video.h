#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/io/video/libav.h"

extern "C" {
#include <libavutil/spherical.h>
#include <libavutil/stereo3d.h>
}

namespace orb360 {

/// One video track of a file that a test writes, and what the file says of it.
struct TrackSpec {
  std::vector<cv::Mat> images;      // CV_8UC3, BGR, or CV_16UC3 for formats of more bits
  std::vector<std::int64_t> times;  // milliseconds; empty: 40 apart
  const char* encoder = "mpeg4";    // by FFmpeg's name
  AVPixelFormat format = AV_PIX_FMT_YUV420P;
  AVColorSpace matrix = AVCOL_SPC_UNSPECIFIED;
  AVColorRange range = AVCOL_RANGE_UNSPECIFIED;
  AVColorTransferCharacteristic transfer = AVCOL_TRC_UNSPECIFIED;
  AVRational sample_aspect = {0, 1};
  std::optional<std::array<std::int32_t, 9>> display_matrix;  // 16.16, last column 2.30
  std::optional<AVSphericalMapping> spherical;
  std::optional<AVStereo3D> stereo;
};

/// Whether FFmpeg has an encoder of that name here.
bool HasEncoder(const char* name);

/// Writes a file of the format that its name tells, with one video track for each spec, nearly
/// without loss.
void WriteVideoFile(const std::filesystem::path& path, const std::vector<TrackSpec>& tracks);

/// Puts the XML of the Spherical Video RFC, version 1, into the first track of an MP4 file whose
/// index is at its end, as WriteVideoFile leaves it.
void InsertGSphericalXml(const std::filesystem::path& path, const std::string& xml);

}  // namespace orb360
