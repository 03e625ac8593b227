#include "slam/io/lenses/calibrate_lenses.h"

#include <algorithm>
#include <vector>

#include "slam/io/lenses/dual_fisheye_video.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

LensEstimate CalibrateLenses(const std::string& video, const LensCalibration& start) {
  constexpr int kFrames = 12;
  const std::unique_ptr<LensVideoSource> source = OpenDualFisheyeVideo(video, start);
  const int stride = std::max(1, source->info().frame_count.value_or(0) / kFrames);
  std::vector<LensMatch> matches;
  LensCalibration scaled;
  for (int i = 0; i < kFrames; ++i) {
    const std::vector<cv::Mat> images = source->ReadImages();
    if (images.empty()) break;
    if (i == 0) scaled = ScaledTo(start, {images[0].size(), images[1].size()}, video);
    const std::vector<LensMatch> more = MatchOverlap(scaled, images);
    matches.insert(matches.end(), more.begin(), more.end());
    for (int skipped = 1; skipped < stride; ++skipped) {
      if (!source->Skip()) break;
    }
  }
  std::optional<LensEstimate> estimate = EstimateLenses(scaled, matches);
  if (!estimate) {
    throw UserError(
        video + ": only " + std::to_string(matches.size()) +
        " places with texture were found that both lenses show; record a scene with "
        "texture at some metres all around, or begin with a calibration that is closer");
  }
  return *estimate;
}

}  // namespace orb360
