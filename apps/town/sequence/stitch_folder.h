#pragma once

#include <filesystem>
#include <functional>
#include <optional>

namespace orb360::town {

struct StitchOptions {
  int width = 2048;                                    ///< of the panoramas, pixels
  double fps = 20;                                     ///< of the recording
  std::optional<double> camera_height = std::nullopt;  ///< metres above the road, if known
  double farthest_depth = 1000;  ///< metres that the largest number of the 24-bit encoding means
};

/// Converts a recording by six cameras (see CubeFace) into a sequence folder of panoramas.
/// `recording` contains a folder of images for each face (front/, right/, back/, left/, up/, down/)
/// with the same names in each. For all or some frames it may contain depth along the optical axis
/// under the same names in depth_front/ ... depth_down/ (16-bit PNG of metres * 256, or 8-bit
/// colour PNG in the 24-bit encoding, see DecodeDepth24), numbers of objects (8 or 16-bit images of
/// one channel) in objects_front/ ... objects_down/, and groundtruth.txt (TUM, time 0 at the first
/// frame), which is copied. Frames have the order of the numbers in their names. Existing panoramas
/// are kept. `progress` is called after each frame with the number done and the total number.
/// Throws UserError.
void StitchFolder(const std::filesystem::path& recording, const std::filesystem::path& folder,
                  const StitchOptions& options,
                  const std::function<void(int done, int all)>& progress);

}  // namespace orb360::town
