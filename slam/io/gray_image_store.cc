#include "slam/io/gray_image_store.h"

#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kQuality = 95;  // of JPEG

}  // namespace

std::filesystem::path GrayImageStore::PathOf(int frame_index) const {
  return folder_.path() / (std::to_string(frame_index) + ".jpg");
}

void GrayImageStore::Put(int frame_index, const cv::Mat& gray) const {
  ORB360_CHECK(gray.type() == CV_8UC1 && !gray.empty(), gray.type(), gray.size());
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", gray, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  // These files are useless after a crash, so the disk is not synced.
  OutputFile file(PathOf(frame_index));
  file.Write({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
}

bool GrayImageStore::Contains(int frame_index) const {
  return std::filesystem::exists(PathOf(frame_index));
}

cv::Mat GrayImageStore::Get(int frame_index) const {
  const std::filesystem::path path = PathOf(frame_index);
  cv::Mat gray = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
  if (gray.empty()) {
    throw UserError(path.string() + ": is damaged or gone; leave the folder as orb360 has made it");
  }
  return gray;
}

}  // namespace orb360
