#include "slam/io/lenses/dual_fisheye_video.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "slam/io/lenses/dual_fisheye_stitcher.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// The names of the files of both lenses, where `path` is one of both.
std::optional<std::pair<std::filesystem::path, std::filesystem::path>> LensFiles(
    const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  // What tells the lens in the name of its file, first lens first.
  constexpr std::pair<const char*, const char*> kMarks[] = {{"GPFR", "GPBK"}, {"_00_", "_10_"}};
  for (const auto& [first, second] : kMarks) {
    for (const char* own : {first, second}) {
      const size_t at = name.find(own);
      if (at == std::string::npos) continue;
      const auto with = [&](const char* mark) {
        std::string other = name;
        return path.parent_path() / other.replace(at, std::string_view(own).size(), mark);
      };
      return std::pair(with(first), with(second));
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<TrackName> FindLensTracks(const std::string& path, bool is_side_by_side) {
  if (is_side_by_side) return {{path, 0}};
  const int count = CountVideoTracks(path);
  if (count >= 2) return {{path, 0}, {path, 1}};
  if (count == 1) {
    const auto files = LensFiles(path);
    if (files && std::filesystem::exists(files->first) && std::filesystem::exists(files->second)) {
      return {{files->first.string(), 0}, {files->second.string(), 0}};
    }
    const std::string missing =
        files ? (std::filesystem::exists(files->first) ? files->second : files->first).string()
              : "the file of the other lens";
    throw UserError(
        path + ": holds the video of one lens, and " + missing +
        " is not there; put both files into one folder under the camera's names, or give a "
        "calibration of two lenses side by side if this video shows both");
  }
  return {{path, 0}};  // VideoTrack says why it cannot be read
}

std::unique_ptr<LensVideoSource> OpenDualFisheyeVideo(const std::string& path,
                                                      const LensCalibration& calibration) {
  LensVideoSource::Plan plan;
  plan.is_side_by_side = calibration.is_side_by_side;
  plan.matches_exposure = kMatchesExposure;
  plan.make_stitcher = [&](const std::vector<cv::Size>& sizes) {
    return std::make_unique<SphereStitcher>(MakeDualFisheyeStitcher(calibration, sizes, path));
  };
  return std::make_unique<LensVideoSource>(path, FindLensTracks(path, calibration.is_side_by_side),
                                           plan);
}

}  // namespace orb360
