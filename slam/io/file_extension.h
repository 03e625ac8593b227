#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

namespace orb360 {

/// The extension of a file name with its dot, ASCII letters in lower case: ".mp4" of "A.MP4".
inline std::string LowerCaseExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return extension;
}

}  // namespace orb360
