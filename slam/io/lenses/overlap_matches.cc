#include "slam/io/lenses/overlap_matches.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kRadian = std::numbers::pi / 180.0;

/// Half of the sizes of patches and how far they are searched, pixels of the ring.
const cv::Size kHalfPatch(16, 12);
constexpr double kMaxError = 3.0 * kRadian;

/// Directions around the first lens's axis where both lenses show something: columns are the angle
/// around the axis, rows the angle from it.
struct Ring {
  cv::Size size;
  double radians_per_pixel = 0.0;
  double first_angle = 0.0;  // from the axis, of the upper edge, radians
  Eigen::Quaterniond camera_from_axis;

  /// Direction in the optical frame of the camera; pixel centres are at integers.
  Eigen::Vector3d Direction(double x, double y) const {
    const double around = (x + 0.5) * 2.0 * std::numbers::pi / size.width;
    const double angle = first_angle + (y + 0.5) * radians_per_pixel;
    return camera_from_axis * Eigen::Vector3d(std::sin(angle) * std::cos(around),
                                              std::sin(angle) * std::sin(around), std::cos(angle));
  }
};

Ring MakeRing(const LensCalibration& calibration) {
  constexpr double kRim = 0.5 * kRadian;  // which is dark
  const auto& [first, second] = calibration.lenses;
  Ring ring;
  ring.radians_per_pixel = 1.0 / std::max(first.focal, second.focal);
  ring.first_angle = std::numbers::pi - 0.5 * second.field_of_view + kRim;
  const double last_angle = 0.5 * first.field_of_view - kRim;
  ring.size = {static_cast<int>(2.0 * std::numbers::pi / ring.radians_per_pixel),
               static_cast<int>((last_angle - ring.first_angle) / ring.radians_per_pixel)};
  ring.camera_from_axis = first.camera_from_lens;
  return ring;
}

Eigen::Vector2d PixelOf(const FisheyeLens& lens, const Eigen::Vector3d& direction) {
  return Project(lens, lens.camera_from_lens.conjugate() * direction);
}

/// The ring as a lens shows it, gray; columns are continued around the axis by `margin` on both
/// sides.
cv::Mat Unroll(const Ring& ring, const FisheyeLens& lens, const cv::Mat& image, int margin) {
  cv::Mat map(ring.size, CV_32FC2);
  for (int y = 0; y < ring.size.height; ++y) {
    for (int x = 0; x < ring.size.width; ++x) {
      const Eigen::Vector2d pixel = PixelOf(lens, ring.Direction(x, y));
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(pixel.x() - 0.5),
                                 static_cast<float>(pixel.y() - 0.5)};
    }
  }
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::Mat unrolled;
  cv::remap(gray, unrolled, map, {}, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  cv::copyMakeBorder(unrolled, unrolled, 0, 0, margin, margin, cv::BORDER_WRAP);
  return unrolled;
}

/// Finds the patch around `at` of one image in another, in which it is at most `search` away.
std::optional<cv::Point2d> FindPatch(const cv::Mat& from, cv::Point at, const cv::Mat& to,
                                     cv::Size search) {
  constexpr double kMinScore = 0.8;
  constexpr double kMinDeviation = 6.0;  // of the patch, gray values
  const cv::Rect all({}, from.size());
  const cv::Rect patch(at.x - kHalfPatch.width, at.y - kHalfPatch.height, 2 * kHalfPatch.width + 1,
                       2 * kHalfPatch.height + 1);
  if ((patch & all) != patch) return std::nullopt;
  cv::Rect area(patch.x - search.width, patch.y - search.height, patch.width + 2 * search.width,
                patch.height + 2 * search.height);
  area &= all;
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(from(patch), mean, deviation);
  if (deviation[0] < kMinDeviation) return std::nullopt;
  cv::Mat scores;
  cv::matchTemplate(to(area), from(patch), scores, cv::TM_CCOEFF_NORMED);
  double score = 0.0;
  cv::Point best;
  cv::minMaxLoc(scores, nullptr, &score, nullptr, &best);
  const bool is_inside =
      best.x > 0 && best.y > 0 && best.x < scores.cols - 1 && best.y < scores.rows - 1;
  if (!is_inside || !(score >= kMinScore)) return std::nullopt;
  const auto vertex = [&](cv::Point step) {  // of the parabola through three scores
    const double before = scores.at<float>(best - step);
    const double after = scores.at<float>(best + step);
    return 0.5 * (before - after) / (before - 2.0 * score + after);
  };
  return cv::Point2d(area.x + best.x + kHalfPatch.width + vertex({1, 0}),
                     area.y + best.y + kHalfPatch.height + vertex({0, 1}));
}

}  // namespace

std::vector<LensMatch> MatchOverlap(const LensCalibration& calibration,
                                    std::span<const cv::Mat> images) {
  constexpr int kStep = 16;           // pixels between patches
  constexpr double kMaxReturn = 1.0;  // pixels between a patch and where the way back leads
  ORB360_CHECK(images.size() == 2, images.size());
  const Ring ring = MakeRing(calibration);
  const int reach = static_cast<int>(kMaxError / ring.radians_per_pixel);
  const cv::Size search(reach, std::min(reach, ring.size.height));
  const int margin = reach + kHalfPatch.width + 1;
  std::vector<LensMatch> matches;
  if (ring.size.height < 2 * kHalfPatch.height + 3) return matches;
  const cv::Mat rings[] = {Unroll(ring, calibration.lenses[0], images[0], margin),
                           Unroll(ring, calibration.lenses[1], images[1], margin)};
  for (int y = kHalfPatch.height; y < ring.size.height - kHalfPatch.height; y += kStep) {
    for (int x = 0; x < ring.size.width; x += kStep) {
      const cv::Point at(x + margin, y);
      const std::optional<cv::Point2d> found = FindPatch(rings[0], at, rings[1], search);
      if (!found) continue;
      const cv::Point rounded(cvRound(found->x), cvRound(found->y));
      const std::optional<cv::Point2d> back = FindPatch(rings[1], rounded, rings[0], search);
      if (!back) continue;
      const cv::Point2d miss = *back - (*found - cv::Point2d(rounded)) - cv::Point2d(at);
      if (std::hypot(miss.x, miss.y) > kMaxReturn) continue;
      matches.push_back(
          {{PixelOf(calibration.lenses[0], ring.Direction(x, y)),
            PixelOf(calibration.lenses[1], ring.Direction(found->x - margin, found->y))}});
    }
  }
  return matches;
}

}  // namespace orb360
