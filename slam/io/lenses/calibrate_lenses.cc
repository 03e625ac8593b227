#include "slam/io/lenses/calibrate_lenses.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "slam/io/folder_source.h"
#include "slam/io/full_sphere.h"
#include "slam/io/image_file.h"
#include "slam/io/lenses/dual_fisheye_stitcher.h"
#include "slam/io/lenses/dual_fisheye_video.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

namespace {

constexpr int kFrames = 12;

using TakeImages = std::function<void(const std::vector<cv::Mat>&)>;

void SampleVideo(const std::string& video, const LensCalibration& calibration,
                 const TakeImages& take) {
  const std::unique_ptr<LensVideoSource> source = OpenDualFisheyeVideo(video, calibration);
  const int stride = std::max(1, source->info().frame_count.value_or(0) / kFrames);
  for (int i = 0; i < kFrames; ++i) {
    if (!source->Skip()) break;
    const std::vector<cv::Mat> images = source->Images();
    if (!images.empty()) take(images);
    for (int skipped = 1; skipped < stride; ++skipped) {
      if (!source->Skip()) break;
    }
  }
}

void SampleFolder(const std::string& folder, const LensCalibration& calibration,
                  const TakeImages& take) {
  RequireSideBySide(calibration, folder);
  const std::vector<std::filesystem::path> files = ListImages(folder, folder);
  const size_t stride = std::max<size_t>(1, files.size() / kFrames);
  cv::Size size;
  for (size_t i = 0; i < files.size() && i / stride < kFrames; i += stride) {
    const LoadedImage loaded = LoadImage(files[i]);
    if (loaded.image.empty()) continue;
    if (size.empty()) size = loaded.image.size();
    if (loaded.image.size() != size) {
      throw UserError(files[i].string() + ": is " + ToString(loaded.image.size()) +
                      ", the images before it are " + ToString(size) +
                      "; all images of a folder must have the same size");
    }
    take(Halves(loaded.image));
  }
}

}  // namespace

LensEstimate CalibrateLenses(const std::string& recording, const LensCalibration& start) {
  std::vector<LensMatch> matches;
  std::optional<LensCalibration> scaled;
  const auto sample = std::filesystem::is_directory(recording) ? SampleFolder : SampleVideo;
  sample(recording, start, [&](const std::vector<cv::Mat>& images) {
    if (!scaled) scaled = ScaledTo(start, {images[0].size(), images[1].size()}, recording);
    const std::vector<LensMatch> more = MatchOverlap(*scaled, images);
    matches.insert(matches.end(), more.begin(), more.end());
  });
  std::optional<LensEstimate> estimate = EstimateLenses(scaled.value_or(start), matches);
  if (!estimate) {
    throw UserError(
        recording + ": only " + std::to_string(matches.size()) +
        " places with texture were found that both lenses show; record a scene with "
        "texture at some metres all around, or begin with a calibration that is closer");
  }
  return *estimate;
}

}  // namespace orb360
