#include "slam/features/orb_extractor.h"

#include <algorithm>
#include <cmath>

#include "slam/features/corner_selection.h"
#include "slam/features/feature_index.h"
#include "slam/features/patch_descriptor.h"
#include "slam/features/tangent_sampling.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/base/option_schema.h>

namespace orb360 {
namespace {

// A level's weight in the distribution of features, a power of its number of pixels. Fine features
// are located better and found again more often, and most coarse ones show a corner that a fine one
// shows too. Coarse features are needed where the distance changes, for example on the way back on
// the other side of a street. The exponent was measured (docs/results/features.md).
double Weight(const PyramidLevel& level) { return std::pow(level.scale, -4.0); }

std::vector<int> FeaturesPerLevel(int num_features, const SpherePyramid& levels) {
  double total = 0;
  for (const PyramidLevel& level : levels) total += Weight(level);
  std::vector<int> counts;
  double assigned = 0;
  for (const PyramidLevel& level : levels) {
    const double next = assigned + num_features * Weight(level) / total;
    counts.push_back(static_cast<int>(std::lround(next) - std::lround(assigned)));
    assigned = next;
  }
  return counts;
}

}  // namespace

OrbExtractor::OrbExtractor(const OrbOptions& options) : options_(options) {
  ValidateOptions(options);
}

Features OrbExtractor::Extract(const cv::Mat& gray, const cv::Mat& mask, int num_threads) {
  ORB360_CHECK(mask.empty() || (mask.type() == CV_8U && mask.size() == gray.size()), mask.cols,
               mask.rows);
  BuildSpherePyramid(gray, options_.num_levels, &levels_, num_threads);
  const SpherePyramid& levels = levels_;
  const std::vector<int> counts = FeaturesPerLevel(options_.num_features, levels);
  const uint8_t min_score = static_cast<uint8_t>(options_.min_score);
  const int num_bands = static_cast<int>(levels.size()) * kSphereBands;
  bands_.resize(num_bands);
  blurred_.resize(num_bands);
  blurred_levels_.resize(levels.size());
  for (size_t l = 0; l < levels.size(); ++l) {
    blurred_levels_[l].create(levels[l].padded.size(), CV_8U);
  }
  std::vector<BandMaxima> maxima(num_bands);
  std::vector<std::vector<Corner>> corners(levels.size());
#pragma omp parallel num_threads(num_threads)
  {
#pragma omp for schedule(dynamic)
    for (int i = 0; i < num_bands; ++i) {
      const int l = i / kSphereBands;
      const int index = i % kSphereBands;
      CutBand(levels[l], index, &bands_[i]);
      maxima[i] = FindMaxima(levels[l], bands_[i], counts[l], min_score, mask);
      BlurBand(index, bands_[i], &blurred_levels_[l], &blurred_[i]);
    }
#pragma omp for schedule(dynamic)
    for (size_t l = 0; l < levels.size(); ++l) {
      const std::span<const BandMaxima> all(maxima);
      corners[l] = SelectCorners(all.subspan(l * kSphereBands, kSphereBands),
                                 levels[l].camera.width(), counts[l]);
    }
  }

  struct Source {
    uint8_t level;
    const Corner* corner;
  };
  std::vector<Source> sources;
  for (size_t l = 0; l < levels.size(); ++l) {
    for (const Corner& corner : corners[l]) sources.push_back({static_cast<uint8_t>(l), &corner});
  }
  const EquirectangularCamera& camera = levels[0].camera;
  Features features;
  features.keypoints.resize(sources.size());
  features.bearings.resize(sources.size());
  features.descriptors.resize(sources.size());
#pragma omp parallel for schedule(static) num_threads(num_threads)
  for (size_t i = 0; i < sources.size(); ++i) {
    const Corner& corner = *sources[i].corner;
    const PyramidLevel& level = levels[sources[i].level];
    const SphereBand& band = blurred_[sources[i].level * kSphereBands + corner.band];
    const OrientedDescriptor description =
        DescribePatch(band.Pixel(corner.x, corner.y), band.stride(),
                      TangentSampling(level.camera, band.width, corner.x, corner.y));
    const Eigen::Vector2d pixel(camera.WrapU(corner.u * level.scale),
                                corner.v * camera.height() / level.camera.height());
    features.keypoints[i] = {
        pixel.cast<float>(), description.angle,
        static_cast<float>(camera.AngleOfPixels(options_.pixel_sigma * level.scale)),
        sources[i].level, corner.score};
    features.bearings[i] = camera.Bearing(pixel);
    features.descriptors[i] = description.bits;
  }
  IndexFeatures(&features);
  return features;
}

}  // namespace orb360
