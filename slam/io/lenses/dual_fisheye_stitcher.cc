#include "slam/io/lenses/dual_fisheye_stitcher.h"

#include "slam/io/full_sphere.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

SphereStitcher MakeDualFisheyeStitcher(const LensCalibration& calibration,
                                       const std::vector<cv::Size>& sizes,
                                       const std::string& name) {
  const LensCalibration scaled = ScaledTo(calibration, sizes, name);
  const cv::Size sphere = SphereSize(scaled);
  const int rows = sizes[0].height + sizes[1].height;
  if (sphere.width > kMaxStitchedSide || rows > kMaxStitchedSide) {
    throw UserError(name + ": lenses of " + ToString(sizes[0]) + " with this calibration make a " +
                    "sphere of " + ToString(sphere) + ", and the images together have " +
                    std::to_string(rows) + " rows; both are limited to " +
                    std::to_string(kMaxStitchedSide) + ": correct `focal`, or scale the images");
  }
  return {sphere, sizes, DualFisheyeSampler(scaled)};
}

std::vector<cv::Mat> Halves(const cv::Mat& image) {
  const int width = image.cols / 2;
  return {image.colRange(0, width), image.colRange(width, 2 * width)};
}

void RequireSideBySide(const LensCalibration& calibration, const std::string& name) {
  if (calibration.is_side_by_side) return;
  throw UserError(name +
                  ": is a folder of images, and --lens describes lenses with a track or file each; "
                  "give a calibration of two lenses side by side, such as insta360-side-by-side");
}

}  // namespace orb360
