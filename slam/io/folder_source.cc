#include "slam/io/folder_source.h"

#include <algorithm>

#include "slam/io/full_sphere.h"
#include "slam/io/image_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// Removes the run of digits at the start of `text` and returns it without leading zeros.
std::string_view TakeNumber(std::string_view& text) {
  const auto end = std::ranges::find_if_not(text, IsDigit);
  std::string_view number(text.begin(), end);
  text.remove_prefix(number.size());
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder,
                                              const std::string& name) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    // File managers leave files with a leading dot behind.
    if (IsImageFileName(entry.path()) && !entry.path().filename().string().starts_with('.') &&
        !entry.is_directory()) {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw UserError(name + ": contains no images (jpg, png, bmp, tif, webp, ppm)");
  }
  std::ranges::sort(files, [](const auto& a, const auto& b) {
    return NaturalLess(a.filename().native(), b.filename().native());
  });
  return files;
}

void RequireSize(const std::filesystem::path& file, cv::Size size, cv::Size expected) {
  if (size == expected) return;
  throw UserError(file.string() + ": is " + ToString(size) + ", the images before it are " +
                  ToString(expected) + "; all images of a folder must have the same size");
}

/// Returns the size of the first image whose size can be found. Throws UserError if the header of
/// another image states a different size.
cv::Size CommonSize(const std::vector<std::filesystem::path>& files, const std::string& name) {
  std::optional<cv::Size> common;
  for (const std::filesystem::path& file : files) {
    std::optional<cv::Size> size = ProbeImageSize(file);
    if (!size && !common) {
      const cv::Mat image = LoadImage(file).image;
      if (!image.empty()) size = image.size();
    }
    if (size && common) RequireSize(file, *size, *common);
    if (!common) common = size;
  }
  if (!common) {
    throw UserError(name + ": none of its " + std::to_string(files.size()) +
                    " images can be decoded");
  }
  return *common;
}

}  // namespace

bool NaturalLess(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (IsDigit(a.front()) && IsDigit(b.front())) {
      const std::string_view number_a = TakeNumber(a);
      const std::string_view number_b = TakeNumber(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // Equal but for leading zeros: any fixed order.
}

FolderSource::FolderSource(const std::filesystem::path& folder, std::string name, double frame_rate,
                           std::optional<double> camera_height)
    : files_(ListImages(folder, name)) {
  ORB360_CHECK(frame_rate > 0.0, frame_rate);
  info_.image_size = CommonSize(files_, name);
  info_.name = std::move(name);
  info_.frame_rate = frame_rate;
  info_.frame_count = static_cast<int>(files_.size());
  info_.camera_height = camera_height;
}

bool FolderSource::Skip() {
  if (next_ == files_.size()) return false;
  ++next_;
  return true;
}

std::optional<Frame> FolderSource::Read() {
  if (next_ == files_.size()) return std::nullopt;
  const std::filesystem::path& file = files_[next_];
  LoadedImage loaded = LoadImage(file);
  if (!loaded.image.empty()) {
    RequireSize(file, loaded.image.size(), info_.image_size);
  } else {
    warnings_.push_back(file.string() + ": " + loaded.problem + "; frame " + std::to_string(next_) +
                        " is skipped");
  }
  const int index = static_cast<int>(next_++);
  return Frame{index, index / info_.frame_rate, loaded.image};
}

}  // namespace orb360
