#pragma once

#include <filesystem>
#include <memory>

#include "slam/io/lenses/lens_calibration.h"
#include <orb360/slam/io/frame_source.h>

namespace orb360 {

/// Opens a folder of images with two fisheye lenses side by side, such as Insta360's `.insp`.
/// Throws UserError where the calibration is of lenses that are not side by side, and as
/// FolderSource does.
std::unique_ptr<FrameSource> OpenDualFisheyeImages(const std::filesystem::path& folder,
                                                   const LensCalibration& calibration);

}  // namespace orb360
