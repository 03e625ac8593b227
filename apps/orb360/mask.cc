#include "apps/orb360/mask.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "apps/orb360/input.h"
#include "slam/io/full_sphere.h"
#include "slam/io/image_file.h"
#include "slam/pipeline/self_mask.h"
#include <orb360/nn/base/check.h>

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

namespace {

cv::Mat ChooseWithoutCoverage(const std::string& choice, const std::string& input,
                              const SequenceOptions& options, const Sequence& sequence) {
  if (choice == "none" || (choice == "auto" && IsRendered(input))) return {};
  if (choice == "auto") return FindSelfMask(input, options, sequence.frame_rate());
  return LoadMask(choice, sequence.image_size());
}

}  // namespace

cv::Mat ChooseMask(const std::string& choice, const std::string& input,
                   const SequenceOptions& options, const Sequence& sequence) {
  const cv::Mat chosen = ChooseWithoutCoverage(choice, input, options, sequence);
  const cv::Mat& coverage = sequence.coverage();
  if (coverage.empty()) return chosen;
  if (chosen.empty()) return coverage;
  return chosen & coverage;
}

void SaveMask(const std::filesystem::path& folder, const cv::Mat& mask) {
  const std::filesystem::path path = folder / kMaskName;
  if (mask.empty()) {
    std::filesystem::remove(path);
  } else {
    WriteImage(path, mask);
  }
}

double ExcludedFraction(const cv::Mat& mask) {
  double excluded = 0.0;
  double all = 0.0;
  for (int row = 0; row < mask.rows; ++row) {
    const double solid_angle = std::sin(std::numbers::pi * (row + 0.5) / mask.rows);
    excluded += solid_angle * (mask.cols - cv::countNonZero(mask.row(row)));
    all += solid_angle * mask.cols;
  }
  return all > 0.0 ? excluded / all : 0.0;
}

}  // namespace orb360
