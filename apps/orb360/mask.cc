#include "apps/orb360/mask.h"

#include <filesystem>

#include <opencv2/imgproc.hpp>

#include "slam/check.h"
#include "slam/io/full_sphere.h"
#include "slam/io/image_file.h"

namespace orb360 {

cv::Mat LoadMask(const std::string& file, cv::Size size) {
  if (!std::filesystem::exists(file)) throw UserError(file + ": no such mask image");
  const LoadedImage loaded = LoadImage(file);
  if (loaded.image.empty()) throw UserError(file + ": this mask image " + loaded.problem);
  RequireFullSphere(file, loaded.image.size());
  cv::Mat mask;
  cv::cvtColor(loaded.image, mask, cv::COLOR_BGR2GRAY);
  cv::resize(mask, mask, size, 0.0, 0.0, cv::INTER_NEAREST);
  return mask >= 128;
}

}  // namespace orb360
