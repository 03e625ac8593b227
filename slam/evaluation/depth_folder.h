#pragma once

#include <filesystem>
#include <optional>

#include "slam/evaluation/depth_calibration.h"
#include "slam/evaluation/depth_error.h"

namespace orb360 {

struct DepthFolderErrors {
  int images = 0;
  DepthErrors errors;
  std::optional<DepthCalibration> calibration;  // of the images with a confidence, if there are any
};

/// Compares the depth images (ReadDepthImage) of two folders that have the same names, and their
/// errors with the images of that name in the folder `confidence` (ReadFractionImage), which need
/// not exist. Throws UserError that names the file if one cannot be read or the sizes differ.
DepthFolderErrors CompareDepthFolders(const std::filesystem::path& truth,
                                      const std::filesystem::path& estimate,
                                      const std::filesystem::path& confidence = {});

}  // namespace orb360
