#pragma once

#include <string>
#include <utility>
#include <vector>

#include "slam/io/panorama_layout.h"
#include "slam/io/video/frame_converter.h"
#include "slam/io/video/image_orientation.h"
#include "slam/io/video/video_track.h"
#include <orb360/slam/io/frame_source.h>

namespace orb360 {

/// Reads the frames of an equirectangular video file. Its first video track is used. Rotation,
/// mirroring, the shape of pixels, stereo, crop and orientation of the sphere are applied as the
/// file says. A file that ends before its announced number of frames (truncated, damaged) gives the
/// frames that can be decoded and a warning. FFmpeg's own messages go where the process has sent
/// them (av_log_set_level).
class VideoSource : public FrameSource {
 public:
  /// `threads` decode, 0 for one for each core. Throws UserError if no video of full spheres can be
  /// read from `path`.
  explicit VideoSource(const std::string& path, int threads = 0);

  const SourceInfo& info() const override { return info_; }
  /// Throws UserError at an image of another size.
  std::optional<Frame> Read() override;
  bool Skip() override;
  std::vector<std::string> TakeWarnings() override { return std::exchange(warnings_, {}); }

 private:
  VideoTrack track_;
  SourceInfo info_;
  std::vector<std::string> warnings_;
  ImageOrientation orientation_;
  std::optional<PanoramaPlacer> placer_;
  FrameConverter converter_;
};

}  // namespace orb360
