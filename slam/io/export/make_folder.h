#pragma once

#include <filesystem>
#include <system_error>

#include "slam/io/output_file.h"

namespace orb360 {

/// Creates a folder and its parents where they do not exist. Throws UserError where that fails.
inline void MakeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) ThrowWriteError(folder, error.value());
}

}  // namespace orb360
