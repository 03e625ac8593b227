#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "slam/evaluation/depth_calibration.h"
#include "slam/evaluation/depth_error.h"

namespace orb360 {

/// Errors of one image.
struct DepthImageErrors {
  std::string name;
  DepthErrorBin total;
};

struct DepthFolderErrors {
  std::vector<DepthImageErrors> images;  // ordered by name
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
