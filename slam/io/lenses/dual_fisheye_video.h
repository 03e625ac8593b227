#pragma once

#include <memory>
#include <string>
#include <vector>

#include "slam/io/lenses/lens_calibration.h"
#include "slam/io/lenses/lens_video_source.h"

namespace orb360 {

/// Returns the video tracks of both lenses of a recording, the first lens first. For a recording
/// with one file for each lens, any of both is given: GoPro Fusion's GPFR0001.MP4 and GPBK0001.MP4,
/// or Insta360's VID_..._00_001.insv and VID_..._10_001.insv, in the same folder. Throws UserError
/// where the second track is missing.
std::vector<TrackName> FindLensTracks(const std::string& path, bool is_side_by_side);

/// Opens a video of two fisheye lenses. Throws UserError if it does not fit the calibration.
std::unique_ptr<LensVideoSource> OpenDualFisheyeVideo(const std::string& path,
                                                      const LensCalibration& calibration);

}  // namespace orb360
