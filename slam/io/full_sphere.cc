#include "slam/io/full_sphere.h"

#include <cmath>

#include <orb360/nn/base/check.h>

namespace orb360 {

bool IsFullSphere(cv::Size size) {
  return size.width > 0 && size.height > 0 &&
         std::abs(size.width / (2.0 * size.height) - 1.0) <= kFullSphereTolerance;
}

void RequireFullSphere(const std::string& name, cv::Size size) {
  if (IsFullSphere(size)) return;
  const std::string problem = name + ": " + ToString(size) + " is not a full sphere";
  if (size.width == size.height) {
    throw UserError(problem +
                    ": a square image may be stereo with one eye above the other; crop it to "
                    "one eye (an equirectangular image is twice as wide as high)");
  }
  throw UserError(
      problem +
      ": an equirectangular image is twice as wide as high; export the recording as "
      "equirectangular (360°) video (a raw one of two fisheye lenses is read with --lens), or "
      "scale it to " +
      ToString({size.width, size.width / 2}) + " if it is a full sphere that was squeezed");
}

std::string ToString(cv::Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace orb360
