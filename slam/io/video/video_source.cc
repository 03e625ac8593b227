#include "slam/io/video/video_source.h"

#include "slam/io/full_sphere.h"
#include "slam/io/video/spherical_metadata.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Returns the orientation, or none where it would turn a full sphere on its side: some cameras
/// write how they were held into files whose images are upright.
ImageOrientation PossibleOrientation(const VideoTrack& track, std::vector<std::string>* warnings) {
  const ImageOrientation orientation = ReadOrientation(track.stream());
  const cv::Size size = track.size();
  if (!IsFullSphere(size) || IsFullSphere(OrientedSize(size, orientation))) return orientation;
  warnings->push_back(track.path() + ": says that its images are to be turned by " +
                      std::to_string(90 * orientation.quarter_turns) +
                      " degrees, but they are full spheres as they are; not turned");
  return {};
}

}  // namespace

VideoSource::VideoSource(const std::string& path, int threads) : track_(path, 0, threads) {
  const PanoramaMetadata metadata = ReadSphericalMetadata(path, 0, track_.stream());
  orientation_ = PossibleOrientation(track_, &warnings_);
  const bool is_on_side = orientation_.quarter_turns % 2 != 0;
  const double aspect = track_.sample_aspect();
  const PanoramaLayout layout = MakePanoramaLayout(path, OrientedSize(track_.size(), orientation_),
                                                   is_on_side ? 1.0 / aspect : aspect, metadata);
  placer_.emplace(layout);
  if (metadata.stereo != StereoMode::kMono) {
    warnings_.push_back(path + ": is stereo; only the left eye is used");
  }
  info_.name = path;
  info_.image_size = layout.shown;
  info_.frame_rate = track_.frame_rate();
  info_.frame_count = track_.frame_count();
  info_.coverage = placer_->coverage();
}

bool VideoSource::Skip() {
  if (track_.Advance()) return true;
  if (const std::optional<std::string> warning = track_.EarlyEnd()) warnings_.push_back(*warning);
  return false;
}

std::optional<Frame> VideoSource::Read() {
  if (!Skip()) return std::nullopt;
  const AVFrame& decoded = track_.frame();
  if (cv::Size(decoded.width, decoded.height) != track_.size()) {
    throw UserError(info_.name + ": frame " + std::to_string(track_.index()) + " is " +
                    ToString({decoded.width, decoded.height}) + ", those before it are " +
                    ToString(track_.size()) + "; all frames must have the same size");
  }
  Frame frame{track_.index(), track_.timestamp(), converter_.ToBgr(decoded)};
  if (frame.image.empty()) {
    warnings_.push_back(info_.name + ": frame " + std::to_string(frame.index) +
                        " cannot be decoded; skipped");
    return frame;
  }
  frame.image = placer_->Place(Oriented(frame.image, orientation_));
  return frame;
}

}  // namespace orb360
