#include "slam/io/image_store.h"

#include <string>
#include <system_error>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kQuality = 95;  // of JPEG

}  // namespace

std::filesystem::path ImageStore::PathOf(int frame_index) const {
  return folder_.path() / (std::to_string(frame_index) + ".jpg");
}

void ImageStore::Put(int frame_index, const cv::Mat& image) const {
  ORB360_CHECK(image.type() == CV_8UC3 && !image.empty(), image.type(), image.size());
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  // These files are useless after a crash, so the disk is not synced.
  OutputFile file(PathOf(frame_index));
  file.Write({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
}

bool ImageStore::Contains(int frame_index) const {
  return std::filesystem::exists(PathOf(frame_index));
}

void ImageStore::Remove(int frame_index) const {
  std::error_code ignored;  // What remains is removed with the folder.
  std::filesystem::remove(PathOf(frame_index), ignored);
}

void ImageStore::Clear() const {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path(), ignored)) {
    std::filesystem::remove(entry.path(), ignored);
  }
}

cv::Mat ImageStore::Read(int frame_index, int flags) const {
  const std::filesystem::path path = PathOf(frame_index);
  cv::Mat image = cv::imread(path.string(), flags);
  if (image.empty()) {
    throw UserError(path.string() + ": is damaged or gone; leave the folder as orb360 has made it");
  }
  return image;
}

cv::Mat ImageStore::Get(int frame_index) const { return Read(frame_index, cv::IMREAD_COLOR); }

cv::Mat ImageStore::GetGray(int frame_index) const {
  return Read(frame_index, cv::IMREAD_GRAYSCALE);
}

}  // namespace orb360
