#include "slam/features/static_region.h"

#include <numbers>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Working resolution: 1.4 degrees per pixel, so that motion is a few pixels at most.
constexpr int kWidth = 256;
constexpr int kHeight = 128;
// Regions that move with the camera are searched below this latitude, rad: 12 degrees below the
// horizon, where the ground is nearer than five times the camera's height.
constexpr double kMaxLatitude = -0.21;
// Number of image pairs that are needed for a decision.
constexpr int kMinPairs = 8;
// Least texture, gray levels per pixel. Below it a change carries no information.
constexpr float kMinTexture = 1.5f;
// Size of the box, pixels, over which texture and change are averaged.
constexpr int kBox = 5;
// The median ratio of change to texture is about the motion in pixels of the working resolution.
// Below this value the camera stands still.
constexpr float kMinMotion = 0.25f;
// A pixel is static if it moves less than this fraction of the median motion.
constexpr float kStaticRatio = 0.3f;
// Differences are capped (gray levels), so that an occluding edge does not outweigh the rest.
constexpr float kMaxChange = 40.0f;
// Nothing was recorded where no image is brighter than this (of 255).
constexpr double kBlack = 12.0;
// Regions smaller than this fraction of the sphere are ignored.
constexpr double kMinArea = 0.004;

double SolidAngleFraction(const cv::Mat& region) {
  double fraction = 0;
  for (int y = 0; y < kHeight; ++y) {
    const double row = 0.5 * (std::cos(std::numbers::pi * y / kHeight) -
                              std::cos(std::numbers::pi * (y + 1) / kHeight));
    fraction += row * cv::countNonZero(region.row(y)) / kWidth;
  }
  return fraction;
}

// Continues the panorama across the seam, so that filters and regions continue there.
cv::Mat Unroll(const cv::Mat& image, int margin) {
  cv::Mat wide;
  cv::copyMakeBorder(image, wide, 0, 0, margin, margin, cv::BORDER_WRAP);
  return wide;
}

// Root of the structure tensor's smaller eigenvalue: the gradient (gray levels per pixel) across
// the direction in which the image varies least. It is zero at an edge, which can move along itself
// unseen.
cv::Mat CornerStrength(const cv::Mat& dx, const cv::Mat& dy) {
  cv::Mat xx;
  cv::Mat xy;
  cv::Mat yy;
  cv::blur(dx.mul(dx), xx, {kBox, kBox});
  cv::blur(dx.mul(dy), xy, {kBox, kBox});
  cv::blur(dy.mul(dy), yy, {kBox, kBox});
  cv::Mat root;
  cv::sqrt((xx - yy).mul(xx - yy) + 4.0 * xy.mul(xy), root);
  cv::Mat strength;
  cv::sqrt(cv::max(0.5 * (xx + yy - root), 0.0), strength);
  return strength;
}

// Keeps connected regions (also across the seam) of at least kMinArea, grown by two pixels.
cv::Mat LargeRegions(const cv::Mat& region) {
  cv::Mat labels;
  const int count = cv::connectedComponents(Unroll(region, kWidth / 2), labels, 8, CV_32S);
  cv::Mat kept = cv::Mat::zeros(region.size(), CV_8U);
  for (int label = 1; label < count; ++label) {
    // Every region lies entirely in one of the two halves of the unrolled image, or spans all of
    // it.
    const cv::Mat wide = labels == label;
    cv::Mat folded = wide(cv::Rect(kWidth / 2, 0, kWidth, kHeight)).clone();
    folded.colRange(kWidth / 2, kWidth) |= wide.colRange(0, kWidth / 2);
    folded.colRange(0, kWidth / 2) |= wide.colRange(kWidth + kWidth / 2, 2 * kWidth);
    if (SolidAngleFraction(folded) >= kMinArea) kept |= folded;
  }
  cv::Mat grown;
  cv::dilate(Unroll(kept, 4), grown, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  return grown.colRange(4, 4 + kWidth).clone();
}

}  // namespace

void StaticRegionDetector::Add(const cv::Mat& image) {
  ORB360_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3, image.type());
  cv::Mat small;
  cv::resize(image, small, {kWidth, kHeight}, 0, 0, cv::INTER_AREA);
  if (small.channels() == 3) cv::cvtColor(small, small, cv::COLOR_BGR2GRAY);
  small.convertTo(small, CV_32F);
  if (previous_.empty()) {
    change_ = cv::Mat::zeros(small.size(), CV_32F);
    gradient_ = cv::Mat::zeros(small.size(), CV_32F);
    brightest_ = small.clone();
  } else {
    cv::Mat change;
    cv::absdiff(small, previous_, change);
    change_ += cv::min(change, kMaxChange);
    cv::Mat dx;
    cv::Mat dy;
    cv::Scharr(Unroll(small, kBox), dx, CV_32F, 1, 0, 1.0 / 32.0);
    cv::Scharr(Unroll(small, kBox), dy, CV_32F, 0, 1, 1.0 / 32.0);
    gradient_ += CornerStrength(dx, dy).colRange(kBox, kBox + kWidth);
    brightest_ = cv::max(brightest_, small);
    ++pairs_;
  }
  previous_ = small;
}

cv::Mat StaticRegionDetector::ChangePerTexture(cv::Mat* texture) const {
  const auto smooth = [&](const cv::Mat& sum) {
    cv::Mat wide;
    cv::blur(Unroll(sum, kBox), wide, {kBox, kBox}, {-1, -1}, cv::BORDER_REPLICATE);
    return cv::Mat(wide.colRange(kBox, kBox + kWidth) / pairs_);
  };
  *texture = smooth(gradient_);
  return smooth(change_) / (*texture + 0.5f * kMinTexture);
}

bool StaticRegionDetector::HasEvidence() const {
  if (pairs_ < kMinPairs) return false;
  cv::Mat texture;
  const cv::Mat ratio = ChangePerTexture(&texture);
  std::vector<float> textured;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (texture.at<float>(y, x) > kMinTexture) textured.push_back(ratio.at<float>(y, x));
    }
  }
  if (textured.size() < 100) return false;
  return Median(textured) > kMinMotion;
}

cv::Mat StaticRegionDetector::Mask(cv::Size size) const {
  cv::Mat hidden = cv::Mat::zeros(kHeight, kWidth, CV_8U);
  if (!previous_.empty()) hidden |= LargeRegions(brightest_ < kBlack);
  if (HasEvidence()) {
    cv::Mat texture;
    const cv::Mat ratio = ChangePerTexture(&texture);
    const cv::Mat textured = texture > kMinTexture;
    std::vector<float> motion;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (textured.at<uint8_t>(y, x) != 0) motion.push_back(ratio.at<float>(y, x));
      }
    }
    cv::Mat still = (ratio < kStaticRatio * Median(motion)) & textured;
    const int first_row = static_cast<int>((0.5 - kMaxLatitude / std::numbers::pi) * kHeight);
    still.rowRange(0, first_row).setTo(0);
    // Smooth parts between static texture belong to the same body.
    cv::Mat closed;
    cv::morphologyEx(Unroll(still, 16), closed, cv::MORPH_CLOSE,
                     cv::getStructuringElement(cv::MORPH_ELLIPSE, {9, 9}));
    hidden |= LargeRegions(closed.colRange(16, 16 + kWidth).clone());
  }
  cv::Mat mask;
  cv::resize(255 - hidden, mask, size, 0, 0, cv::INTER_NEAREST);
  return mask;
}

}  // namespace orb360
