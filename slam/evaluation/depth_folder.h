#pragma once

#include <filesystem>

#include "slam/evaluation/depth_error.h"

namespace orb360 {

struct DepthFolderErrors {
  int images = 0;
  DepthErrors errors;
};

/// Compares the depth images (ReadDepthImage) of two folders that have the same names. Throws
/// UserError that names the file if one cannot be read or the sizes differ.
DepthFolderErrors CompareDepthFolders(const std::filesystem::path& truth,
                                      const std::filesystem::path& estimate);

}  // namespace orb360
