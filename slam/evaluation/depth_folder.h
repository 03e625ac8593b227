#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "slam/evaluation/depth_calibration.h"
#include "slam/evaluation/depth_error.h"
#include <orb360/slam/depth/dense_depth.h>

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
  std::map<RangeSource, DepthCalibration> by_source;  // of those with a source as well
};

/// Compares the depth images (ReadDepthImage) of two folders that have the same names, and their
/// errors with the images of that name in the folders `confidence` (ReadFractionImage) and `source`
/// (ReadSourceImage), which need not exist. Throws UserError that names the file if one cannot be
/// read or the sizes differ.
DepthFolderErrors CompareDepthFolders(const std::filesystem::path& truth,
                                      const std::filesystem::path& estimate,
                                      const std::filesystem::path& confidence = {},
                                      const std::filesystem::path& source = {});

}  // namespace orb360
