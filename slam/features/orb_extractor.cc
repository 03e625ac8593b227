#include "slam/features/orb_extractor.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "slam/check.h"
#include "slam/features/corner_selection.h"
#include "slam/features/patch_descriptor.h"
#include "slam/features/tangent_sampling.h"

namespace orb360 {
namespace {

// Blurs all levels: descriptors compare single pixels. In strips, for the threads to share.
void Blur(const std::vector<PyramidLevel>& levels, std::vector<cv::Mat>* blurred) {
  constexpr int kStripRows = 128;
  struct Strip {
    size_t level;
    cv::Range rows;
  };
  std::vector<Strip> strips;
  blurred->resize(levels.size());
  for (size_t l = 0; l < levels.size(); ++l) {
    const cv::Mat& padded = levels[l].padded;
    (*blurred)[l].create(padded.size(), CV_8U);
    for (int y = 0; y < padded.rows; y += kStripRows) {
      strips.push_back({l, cv::Range(y, std::min(y + kStripRows, padded.rows))});
    }
  }
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < strips.size(); ++i) {
    const Strip& strip = strips[i];
    // Rows beyond the strip are read from the level itself.
    cv::Mat out = (*blurred)[strip.level].rowRange(strip.rows);
    cv::GaussianBlur(levels[strip.level].padded.rowRange(strip.rows), out, cv::Size(7, 7), 2.0, 2.0,
                     cv::BORDER_REPLICATE);
  }
}

// Features per level in proportion to its resolution (pixels per radian), as many small ones as
// the image can place well.
std::vector<int> ShareOut(int num_features, const std::vector<PyramidLevel>& levels) {
  double total = 0;
  for (const PyramidLevel& level : levels) total += 1.0 / level.scale;
  std::vector<int> counts;
  double assigned = 0;
  for (const PyramidLevel& level : levels) {
    const double next = assigned + num_features / level.scale / total;
    counts.push_back(static_cast<int>(std::lround(next) - std::lround(assigned)));
    assigned = next;
  }
  return counts;
}

}  // namespace

OrbExtractor::OrbExtractor(const OrbOptions& options) : options_(options) {
  ORB360_CHECK(options.num_features > 0 && options.num_levels > 0, options.num_features,
               options.num_levels);
  ORB360_CHECK(options.min_score > 0 && options.min_score < 256, options.min_score);
}

Features OrbExtractor::Extract(const cv::Mat& gray, const cv::Mat& mask) {
  ORB360_CHECK(mask.empty() || (mask.type() == CV_8U && mask.size() == gray.size()), mask.cols,
               mask.rows);
  BuildSpherePyramid(gray, options_.num_levels, &levels_);
  const std::vector<PyramidLevel>& levels = levels_;
  const std::vector<int> counts = ShareOut(options_.num_features, levels);
  const EquirectangularCamera& camera = levels[0].camera;

  const std::vector<std::vector<Corner>> corners =
      SelectCorners(levels, counts, static_cast<uint8_t>(options_.min_score), mask);
  Blur(levels, &blurred_);

  struct Source {
    uint8_t level;
    const Corner* corner;
  };
  std::vector<Source> sources;
  for (size_t l = 0; l < levels.size(); ++l) {
    for (const Corner& corner : corners[l]) sources.push_back({static_cast<uint8_t>(l), &corner});
  }
  Features features;
  features.keypoints.resize(sources.size());
  features.bearings.resize(sources.size());
  features.descriptors.resize(sources.size());
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < sources.size(); ++i) {
    const Corner& corner = *sources[i].corner;
    const PyramidLevel& level = levels[sources[i].level];
    const cv::Mat& image = blurred_[sources[i].level];
    const OrientedDescriptor description = DescribePatch(
        image.ptr(corner.y + PyramidLevel::kMarginY) + corner.x + PyramidLevel::kMarginX,
        static_cast<ptrdiff_t>(image.step), TangentSampling(level.camera, corner.x, corner.y));
    const Eigen::Vector2d pixel(
        camera.WrapU((corner.x + 0.5 + corner.dx) * level.scale),
        (corner.y + 0.5 + corner.dy) * camera.height() / level.camera.height());
    features.keypoints[i] = {
        pixel.cast<float>(), description.angle,
        static_cast<float>(camera.AngleOfPixels(options_.pixel_sigma * level.scale)),
        sources[i].level, corner.score};
    features.bearings[i] = camera.Bearing(pixel);
    features.descriptors[i] = description.bits;
  }
  features.grid = SphereGrid(features.bearings);
  return features;
}

}  // namespace orb360
