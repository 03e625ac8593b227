#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "slam/io/lenses/sphere_stitcher.h"
#include "slam/io/video/frame_converter.h"
#include "slam/io/video/video_track.h"
#include <orb360/slam/io/frame_source.h>

namespace orb360 {

/// One video track of a file.
struct TrackName {
  std::string path;
  /// Counted from 0 among the video tracks of the file.
  int number = 0;
};

/// Reads the images of the lenses of a camera from one or two video tracks and stitches them to
/// full spheres. Frames of two tracks belong together when their times agree to half a frame;
/// others are left out, with a warning at the end.
class LensVideoSource : public FrameSource {
 public:
  /// How the images of the tracks become a sphere.
  struct Plan {
    /// One track holds the images of two lenses, the left half and the right half.
    bool is_side_by_side = false;
    bool matches_exposure = false;
    /// Makes the stitcher for the sizes of the images. Throws UserError where they do not fit.
    std::function<std::unique_ptr<SphereStitcher>(const std::vector<cv::Size>&)> make_stitcher;
  };

  /// Messages call the input `name`. Throws UserError if a track cannot be read.
  LensVideoSource(const std::string& name, const std::vector<TrackName>& tracks, const Plan& plan);

  const SourceInfo& info() const override { return info_; }
  std::optional<Frame> Read() override;
  bool Skip() override;
  std::vector<std::string> TakeWarnings() override { return std::exchange(warnings_, {}); }

  /// The images of the lenses in the frame that Skip has gone to, without stitching them; empty
  /// where it cannot be decoded.
  std::vector<cv::Mat> Images();

 private:
  SourceInfo info_;
  bool is_side_by_side_ = false;
  bool matches_exposure_ = false;
  std::vector<std::unique_ptr<VideoTrack>> tracks_;
  std::vector<FrameConverter> converters_;
  std::unique_ptr<SphereStitcher> stitcher_;
  std::vector<std::string> warnings_;
  double second_start_ = 0.0;  // of the second track after that of the first one, seconds
  int index_ = -1;             // of the present pair of frames
  int unpaired_ = 0;           // frames of one track without one of the other
  bool has_ended_ = false;
};

/// Opens the `.360` file of a GoPro camera (EacLayout). Throws UserError if a track is missing or
/// of another layout.
std::unique_ptr<FrameSource> OpenEacVideo(const std::string& path);

}  // namespace orb360
