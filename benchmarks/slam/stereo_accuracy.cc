// How well stereo on the sphere measures ranges: against true poses and depth.
//
//   stereo_accuracy SEQUENCE [--images DIR] [--opencv] [--avx2] [GAP...]
//
// For the frames of a sequence folder with true depth and the frames GAP after each [1 -1 2 -2]:
// how much of what has texture and is nearer than 30 m gets a range, by solid angle, and how large
// its errors are; then how much of all that gets a range is wrong by more than 10 % or shows the
// sky, and how much of this lies beside the edge of a near surface (FindOccludingBoundary, where
// what has no measured range has the true one). --images: writes the image, the true ranges and the
// measured ones below each other, as colours of the logarithm of 0.5 to 50 m, and the errors.
// --opencv: the same with the semi-global matcher of OpenCV on the same rectified images, for
// comparison. --avx2: without AVX-512, for the time on a processor that has none; OpenCV goes on
// using it.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <hwy/targets.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "benchmarks/slam/sequence_folder.h"
#include "nn/base/statistics.h"
#include "slam/depth/occluding_boundary.h"
#include "slam/stereo/spherical_stereo.h"
#include <orb360/slam/io/depth_image.h>
#include <orb360/slam/io/trajectory.h>

namespace {

namespace fs = std::filesystem;

constexpr float kMaxRange = 30.0F;  // metres

/// Where the gray values within 5 x 5 pixels have a standard deviation of at least 3 levels.
cv::Mat HasTexture(const cv::Mat& gray) {
  const cv::Size window(5, 5);
  cv::Mat mean;
  cv::Mat square;
  cv::boxFilter(gray, mean, CV_32F, window);
  cv::sqrBoxFilter(gray, square, CV_32F, window);
  return square - mean.mul(mean) >= 9.0;
}

/// Solid angles, in units of a pixel at the equator, of what has a range.
struct BoundaryTotals {
  double right = 0;
  double wrong = 0;  // by more than 10 %, or it is the sky
  double right_beside = 0;
  double wrong_beside = 0;

  void Add(const cv::Mat& truth, const orb360::InverseRanges& measured) {
    constexpr double kSky = 1e4;  // metres
    cv::Mat ranges = truth.clone();
    ranges.setTo(kSky, ~(truth > 0));
    cv::Mat known;
    cv::divide(1.0, measured.value, known);
    known.copyTo(ranges, measured.value > 0);
    const cv::Mat beside = orb360::FindOccludingBoundary(ranges);
    for (int row = 0; row < truth.rows; ++row) {
      const double weight = std::sin((row + 0.5) / truth.rows * std::numbers::pi);
      for (int column = 0; column < truth.cols; ++column) {
        const float inverse = measured.value.at<float>(row, column);
        if (!(inverse > 0)) continue;
        const float range = truth.at<float>(row, column);
        const bool is_right = range > 0 && std::abs(inverse * range - 1) < 0.1F;
        (is_right ? right : wrong) += weight;
        if (beside.at<uint8_t>(row, column) == 0) continue;
        (is_right ? right_beside : wrong_beside) += weight;
      }
    }
  }
};

/// Solid angles, in units of a pixel at the equator, and errors of what was measured.
struct Totals {
  double textured = 0;
  double known = 0;
  double within3 = 0;
  double within10 = 0;
  std::vector<double> in_sigmas;
  std::vector<double> milliseconds;

  void Add(const cv::Mat& gray, const cv::Mat& truth, const orb360::InverseRanges& measured) {
    const cv::Mat texture = HasTexture(gray);
    for (int row = 0; row < truth.rows; ++row) {
      const double weight = std::sin((row + 0.5) / truth.rows * std::numbers::pi);
      for (int column = 0; column < truth.cols; ++column) {
        const float range = truth.at<float>(row, column);
        if (!(range > 0 && range < kMaxRange) || texture.at<uint8_t>(row, column) == 0) continue;
        textured += weight;
        const float sigma = measured.sigma.at<float>(row, column);
        if (!(sigma > 0)) continue;
        known += weight;
        const double error = measured.value.at<float>(row, column) - 1 / range;
        within3 += std::abs(error) * range < 0.03 ? weight : 0;
        within10 += std::abs(error) * range < 0.1 ? weight : 0;
        in_sigmas.push_back(std::abs(error) / sigma);
      }
    }
  }
};

/// Colours of ranges; black where unknown.
cv::Mat ColorsOf(const cv::Mat& ranges) {
  cv::Mat logarithm;
  cv::log(ranges * 2, logarithm);  // 0 at 0.5 m
  cv::Mat levels;
  logarithm.convertTo(levels, CV_8U, 255 / std::log(100.0));
  cv::Mat colors;
  cv::applyColorMap(levels, colors, cv::COLORMAP_TURBO);
  colors.setTo(0, ~(ranges > 0));
  return colors;
}

/// Colours of the relative errors: blue too far, red too near by 10 % or more, white right; black
/// where unknown.
cv::Mat ColorsOfErrors(const cv::Mat& truth, const orb360::InverseRanges& measured) {
  cv::Mat colors(truth.size(), CV_8UC3, cv::Scalar(0, 0, 0));
  for (int row = 0; row < truth.rows; ++row) {
    for (int column = 0; column < truth.cols; ++column) {
      const float range = truth.at<float>(row, column);
      const float inverse = measured.value.at<float>(row, column);
      if (!(range > 0) || !(inverse > 0)) continue;
      const double error = std::clamp((inverse * range - 1) / 0.1, -1.0, 1.0);
      const auto rest = static_cast<uint8_t>(255 * (1 - std::abs(error)));
      colors.at<cv::Vec3b>(row, column) =
          error > 0 ? cv::Vec3b(rest, rest, 255) : cv::Vec3b(255, rest, rest);
    }
  }
  return colors;
}

void WriteImage(const fs::path& path, const cv::Mat& gray, const cv::Mat& truth,
                const orb360::InverseRanges& measured) {
  cv::Mat ranges;
  cv::divide(1.0, measured.value, ranges);
  ranges.setTo(0, ~(measured.value > 0));
  cv::Mat shown;
  cv::cvtColor(gray, shown, cv::COLOR_GRAY2BGR);
  cv::vconcat(std::vector<cv::Mat>{shown, ColorsOf(truth), ColorsOf(ranges),
                                   ColorsOfErrors(truth, measured)},
              shown);
  if (!cv::imwrite(path.string(), shown)) throw std::runtime_error("cannot write " + path.string());
}

/// The semi-global matcher of OpenCV, with the penalties that its documentation advises, a check
/// from left to right, and its filter of speckles.
orb360::RefinedDisparities MatchByOpenCv(const cv::Mat& first, const cv::Mat& second) {
  constexpr int kWindow = 5;  // pixels
  constexpr double kFixedPoint = 16;
  const int num_disparities = first.cols / 2;  // as many as this project's matcher searches
  const auto matcher = cv::StereoSGBM::create(
      0, num_disparities, kWindow, 8 * kWindow * kWindow, 32 * kWindow * kWindow,
      /*disp12MaxDiff=*/1, /*preFilterCap=*/31, /*uniquenessRatio=*/10, /*speckleWindowSize=*/100,
      /*speckleRange=*/2, cv::StereoSGBM::MODE_SGBM);
  // Its disparities are columns of the left image less columns of the right one. With a margin it
  // searches the first columns, too.
  cv::Mat left;
  cv::Mat right;
  cv::flip(first, left, 1);
  cv::flip(second, right, 1);
  cv::copyMakeBorder(left, left, 0, 0, num_disparities, 0, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(right, right, 0, 0, num_disparities, 0, cv::BORDER_REPLICATE);
  cv::Mat disparity;
  matcher->compute(left, right, disparity);
  disparity = disparity.colRange(num_disparities, disparity.cols);
  cv::flip(disparity, disparity, 1);
  disparity.convertTo(disparity, CV_32F, 1 / kFixedPoint);
  return {disparity, cv::Mat(disparity.size(), CV_32F, cv::Scalar(0.25))};
}

void Measure(const fs::path& sequence, const std::optional<fs::path>& images, bool uses_opencv,
             const std::optional<orb360::PlaneHypothesis>& ground, const std::vector<int>& gaps) {
  const auto poses = orb360::ReadTrajectory(sequence / "groundtruth.txt");
  const auto count = static_cast<int>(poses.size());
  if (images) fs::create_directories(*images);
  orb360::SphericalStereoOptions options;
  if (uses_opencv) options.matcher = MatchByOpenCv;
  Totals totals;
  BoundaryTotals boundary;
  for (int i = 0; i < count; ++i) {
    const fs::path depth = sequence / "depth" / orb360::NameOfFrame(i, "png");
    if (!fs::exists(depth)) continue;
    const cv::Mat truth = orb360::ReadDepthImage(depth);
    const orb360::StereoView reference{orb360::ReadGray(sequence, i), poses[i].world_from_camera};
    if (reference.gray.size() != truth.size()) {
      throw std::runtime_error(depth.string() + ": has another size than its image");
    }
    std::vector<orb360::StereoView> sources;
    for (const int gap : gaps) {
      if (i + gap < 0 || i + gap >= count) continue;
      sources.push_back({orb360::ReadGray(sequence, i + gap), poses[i + gap].world_from_camera});
    }
    if (static_cast<int>(sources.size()) < options.fusion.min_support) continue;
    const auto start = std::chrono::steady_clock::now();
    const orb360::InverseRanges fused = MatchSpheres(reference, sources, options, 2, ground);
    totals.milliseconds.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
    totals.Add(reference.gray, truth, fused);
    boundary.Add(truth, fused);
    if (images) WriteImage(*images / orb360::NameOfFrame(i, "png"), reference.gray, truth, fused);
  }
  if (totals.in_sigmas.empty()) throw std::runtime_error("no frame with depth has a range");
  std::printf("%zu frames, %.0f ms each\n", totals.milliseconds.size(),
              orb360::Median(totals.milliseconds));
  std::printf("with a range, of what has texture and is nearer than 30 m: %.1f %%\n",
              100 * totals.known / totals.textured);
  std::printf("of these within 3 %%: %.1f %%, within 10 %%: %.1f %%\n",
              100 * totals.within3 / totals.known, 100 * totals.within10 / totals.known);
  std::printf("|error| in standard deviations: 68 %% below %.2f, 95 %% below %.2f\n",
              orb360::NearestRankQuantile(totals.in_sigmas, 0.68),
              orb360::NearestRankQuantile(totals.in_sigmas, 0.95));
  std::printf(
      "of all with a range wrong by more than 10 %% or sky: %.1f %%; beside an edge: %.0f %% of "
      "the "
      "wrong ones, %.1f %% of the others\n",
      100 * boundary.wrong / (boundary.wrong + boundary.right),
      100 * boundary.wrong_beside / boundary.wrong, 100 * boundary.right_beside / boundary.right);
}

constexpr char kUsage[] =
    "usage: stereo_accuracy SEQUENCE [--images DIR] [--ground HEIGHT] [--opencv] [--avx2] "
    "[GAP...]\n"
    "SEQUENCE: folder with rgb/, depth/ and groundtruth.txt, the world's z axis up; --ground: "
    "level\n"
    "ground HEIGHT below the camera is tried as well; --opencv: OpenCV's matcher; --avx2: without\n"
    "AVX-512;\n"
    "GAP: frames from a reference view to a source view, two or more, not 0 [1 -1 2 -2]\n";

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  std::optional<fs::path> images;
  std::optional<orb360::PlaneHypothesis> ground;
  bool uses_opencv = false;
  std::vector<int> gaps;
  bool is_valid = !arguments.empty();
  for (size_t i = 1; i < arguments.size(); ++i) {
    if (arguments[i] == "--images" && i + 1 < arguments.size()) {
      images = arguments[++i];
      continue;
    }
    if (arguments[i] == "--ground" && i + 1 < arguments.size()) {
      const double height = std::atof(arguments[++i].c_str());
      ground = {Eigen::Vector3d::UnitZ(), height};
      is_valid = is_valid && height > 0;
      continue;
    }
    if (arguments[i] == "--opencv") {
      uses_opencv = true;
      continue;
    }
    if (arguments[i] == "--avx2") {
      hwy::DisableTargets(HWY_AVX2 - 1);  // a better set of instructions has a lower bit
      continue;
    }
    gaps.push_back(std::atoi(arguments[i].c_str()));
    is_valid = is_valid && gaps.back() != 0;
  }
  if (gaps.empty()) gaps = {1, -1, 2, -2};
  const bool wants_help = arguments.size() == 1 && arguments[0] == "--help";
  if (wants_help || !is_valid || gaps.size() < 2) {
    std::fputs(kUsage, wants_help ? stdout : stderr);
    return wants_help ? 0 : 2;
  }
  try {
    Measure(arguments[0], images, uses_opencv, ground, gaps);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stereo_accuracy: %s\n", error.what());
    return 1;
  }
  return 0;
}
