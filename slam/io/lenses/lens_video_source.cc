#include "slam/io/lenses/lens_video_source.h"

#include <algorithm>
#include <cmath>

#include "slam/io/full_sphere.h"
#include "slam/io/lenses/dual_fisheye_stitcher.h"
#include "slam/io/lenses/eac.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

LensVideoSource::LensVideoSource(const std::string& name, const std::vector<TrackName>& tracks,
                                 const Plan& plan)
    : is_side_by_side_(plan.is_side_by_side), matches_exposure_(plan.matches_exposure) {
  std::vector<cv::Size> sizes;
  for (const TrackName& track : tracks) {
    tracks_.push_back(std::make_unique<VideoTrack>(track.path, track.number));
    sizes.push_back(tracks_.back()->size());
  }
  // Tracks of one file have one clock; files of their own begin together.
  if (tracks.size() == 2 && tracks[0].path == tracks[1].path) {
    second_start_ = tracks_[1]->start_time() - tracks_[0]->start_time();
  }
  converters_.resize(tracks_.size());
  if (is_side_by_side_) sizes.assign(2, {sizes[0].width / 2, sizes[0].height});
  stitcher_ = plan.make_stitcher(sizes);
  info_.name = name;
  info_.image_size = stitcher_->sphere();
  info_.frame_rate = tracks_[0]->frame_rate();
  info_.frame_count = tracks_[0]->frame_count();
  info_.coverage = stitcher_->coverage();
}

bool LensVideoSource::Skip() {
  if (has_ended_) return false;
  bool has_frames =
      std::ranges::all_of(tracks_, [](const auto& track) { return track->Advance(); });
  const double tolerance = 0.5 / info_.frame_rate;
  while (has_frames && tracks_.size() == 2) {
    const double ahead = tracks_[0]->timestamp() - tracks_[1]->timestamp() - second_start_;
    if (std::abs(ahead) <= tolerance) break;
    ++unpaired_;
    has_frames = tracks_[ahead > 0.0 ? 1 : 0]->Advance();
  }
  if (has_frames) {
    ++index_;
    return true;
  }
  has_ended_ = true;
  for (const auto& track : tracks_) {
    if (const std::optional<std::string> warning = track->EarlyEnd()) warnings_.push_back(*warning);
  }
  if (unpaired_ > 0) {
    warnings_.push_back(info_.name + ": " + std::to_string(unpaired_) +
                        " frames of one lens have none of the other at the same time; left out");
  }
  return false;
}

std::vector<cv::Mat> LensVideoSource::Images() {
  std::vector<cv::Mat> images;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const AVFrame& frame = tracks_[i]->frame();
    if (cv::Size(frame.width, frame.height) != tracks_[i]->size()) {
      throw UserError(tracks_[i]->path() + ": frame " + std::to_string(tracks_[i]->index()) +
                      " is " + ToString({frame.width, frame.height}) + ", those before it are " +
                      ToString(tracks_[i]->size()) + "; all frames must have the same size");
    }
    images.push_back(converters_[i].ToBgr(frame));
    if (images.back().empty()) return {};
  }
  return is_side_by_side_ ? Halves(images[0]) : images;
}

std::optional<Frame> LensVideoSource::Read() {
  if (!Skip()) return std::nullopt;
  Frame frame{index_, tracks_[0]->timestamp(), {}};
  const std::vector<cv::Mat> images = Images();
  if (images.empty()) {
    warnings_.push_back(info_.name + ": frame " + std::to_string(frame.index) +
                        " cannot be decoded; skipped");
  } else {
    frame.image = stitcher_->Stitch(images, matches_exposure_);
  }
  return frame;
}

std::unique_ptr<FrameSource> OpenEacVideo(const std::string& path) {
  if (const int count = CountVideoTracks(path); count == 1) {
    throw UserError(path +
                    ": has one video track, and a .360 file of a GoPro camera has two; copy the "
                    "original from the camera, or export it as equirectangular video");
  }
  LensVideoSource::Plan plan;
  plan.make_stitcher = [&](const std::vector<cv::Size>& sizes) {
    const std::optional<EacLayout> layout = EacLayoutOf(sizes[0]);
    if (!layout || sizes[1] != sizes[0]) {
      throw UserError(path + ": its video tracks are " + ToString(sizes[0]) + " and " +
                      ToString(sizes[1]) +
                      "; those of a .360 file are both three cube faces with overlap, such as "
                      "4096x1344");
    }
    return std::make_unique<SphereStitcher>(layout->sphere(), sizes, EacSampler(*layout));
  };
  return std::make_unique<LensVideoSource>(path, std::vector<TrackName>{{path, 0}, {path, 1}},
                                           plan);
}

}  // namespace orb360
