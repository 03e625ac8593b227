#pragma once

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include "slam/io/image_file.h"

namespace orb360 {

/// Name of a frame's file in a sequence folder: six digits and an ending.
inline std::string NameOfFrame(int index, const char* ending) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d.%s", index, ending);
  return name;
}

/// Reads rgb/NNNNNN.jpg, or .png, of a sequence folder as CV_8UC3 (BGR). Throws std::runtime_error
/// where it cannot be read.
inline cv::Mat ReadColor(const std::filesystem::path& sequence, int index) {
  std::filesystem::path path = sequence / "rgb" / NameOfFrame(index, "jpg");
  if (!std::filesystem::exists(path)) path.replace_extension("png");
  const LoadedImage loaded = LoadImage(path);
  if (!loaded.problem.empty()) throw std::runtime_error(path.string() + ": " + loaded.problem);
  return loaded.image;
}

/// The same as CV_8U.
inline cv::Mat ReadGray(const std::filesystem::path& sequence, int index) {
  cv::Mat gray;
  cv::cvtColor(ReadColor(sequence, index), gray, cv::COLOR_BGR2GRAY);
  return gray;
}

}  // namespace orb360
