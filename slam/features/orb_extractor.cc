#include "slam/features/orb_extractor.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <opencv2/imgproc.hpp>

#include "slam/check.h"
#include "slam/features/corner_selection.h"
#include "slam/features/tangent_sampling.h"

namespace orb360 {
namespace {

constexpr int kPatchRadius = 15;  // pixels of the level; ORB's 31 x 31 patch
constexpr int kComparisons = 256;
constexpr int kPoints = 2 * kComparisons;

struct Points {
  std::vector<float> a;  // east
  std::vector<float> b;  // south
};

// Points of the comparisons: number i compares points 2i and 2i+1, each drawn from a Gaussian of a
// fifth of the patch's size (Calonder et al., BRIEF, ECCV 2010: the best of their layouts). The
// generator is fixed: descriptors are part of stored maps.
Points MakeComparisonPattern() {
  constexpr double kSigma = (2 * kPatchRadius + 1) / 5.0;
  constexpr double kMinSeparation = 3.0;  // pixels; nearer points are one after blurring
  std::mt19937 random(360);
  const auto uniform = [&] { return (random() + 0.5) / 4294967296.0; };
  const auto draw = [&] {
    while (true) {  // Box-Muller: the standard library's own distributions differ by vendor
      const double radius = kSigma * std::sqrt(-2.0 * std::log(uniform()));
      const double angle = 2.0 * std::numbers::pi * uniform();
      if (radius <= kPatchRadius) {
        return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
      }
    }
  };
  Points pattern;
  while (pattern.a.size() < kPoints) {
    const Eigen::Vector2d p = draw();
    const Eigen::Vector2d q = draw();
    if ((p - q).norm() < kMinSeparation) continue;
    for (const Eigen::Vector2d& point : {p, q}) {
      pattern.a.push_back(static_cast<float>(point.x()));
      pattern.b.push_back(static_cast<float>(point.y()));
    }
  }
  return pattern;
}

// Every second pixel of the disc: the image is blurred by more than that.
Points MakeMomentPattern() {
  Points pattern;
  for (int b = -kPatchRadius; b <= kPatchRadius; b += 2) {
    for (int a = -kPatchRadius; a <= kPatchRadius; a += 2) {
      if (a * a + b * b > kPatchRadius * kPatchRadius) continue;
      pattern.a.push_back(static_cast<float>(a));
      pattern.b.push_back(static_cast<float>(b));
    }
  }
  return pattern;
}

// Angle of the intensity centroid (Rublee et al., ORB, ICCV 2011), from east towards south.
float Orientation(const uint8_t* center, const Points& points, const int32_t* offsets) {
  int east = 0;
  int south = 0;
  for (size_t i = 0; i < points.a.size(); ++i) {
    const int value = center[offsets[i]];
    east += static_cast<int>(points.a[i]) * value;
    south += static_cast<int>(points.b[i]) * value;
  }
  return std::atan2(static_cast<float>(south), static_cast<float>(east));
}

Descriptor Compare(const uint8_t* center, const int32_t* offsets) {
  Descriptor descriptor{};
  for (int word = 0; word < 4; ++word) {
    uint64_t bits = 0;
    for (int bit = 0; bit < 64; ++bit) {
      const int32_t* pair = offsets + 2 * (64 * word + bit);
      bits |= uint64_t{center[pair[0]] < center[pair[1]]} << bit;
    }
    descriptor[word] = bits;
  }
  return descriptor;
}

// Orientation and descriptor of the patch around a pixel of the blurred level.
void Describe(const PyramidLevel& level, const cv::Mat& blurred, int x, int y, float* angle,
              Descriptor* descriptor) {
  static const Points kComparison = MakeComparisonPattern();
  static const Points kMoments = MakeMomentPattern();
  const ptrdiff_t stride = static_cast<ptrdiff_t>(blurred.step);
  const uint8_t* center = blurred.ptr(y + PyramidLevel::kMarginY) + x + PyramidLevel::kMarginX;
  const TangentSampling sampling(level.camera, y + 0.5);
  std::array<int32_t, kPoints> offsets;
  sampling.Offsets(kMoments.a, kMoments.b, x, y, stride, offsets.data());
  *angle = Orientation(center, kMoments, offsets.data());

  const float cosine = std::cos(*angle);
  const float sine = std::sin(*angle);
  std::array<float, kPoints> a;
  std::array<float, kPoints> b;
  for (int i = 0; i < kPoints; ++i) {
    a[i] = cosine * kComparison.a[i] - sine * kComparison.b[i];
    b[i] = sine * kComparison.a[i] + cosine * kComparison.b[i];
  }
  sampling.Offsets(a, b, x, y, stride, offsets.data());
  *descriptor = Compare(center, offsets.data());
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

Features OrbExtractor::Extract(const cv::Mat& gray, const cv::Mat& mask) const {
  ORB360_CHECK(mask.empty() || (mask.type() == CV_8U && mask.size() == gray.size()), mask.cols,
               mask.rows);
  const std::vector<PyramidLevel> levels = BuildSpherePyramid(gray, options_.num_levels);
  const std::vector<int> counts = ShareOut(options_.num_features, levels);
  const EquirectangularCamera& camera = levels[0].camera;

  Features features;
  for (size_t l = 0; l < levels.size(); ++l) {
    const PyramidLevel& level = levels[l];
    const std::vector<Corner> corners =
        SelectCorners(level, counts[l], static_cast<uint8_t>(options_.min_score), mask);
    cv::Mat blurred;
    cv::GaussianBlur(level.padded, blurred, cv::Size(7, 7), 2.0, 2.0, cv::BORDER_REPLICATE);

    const int first = features.size();
    const int count = static_cast<int>(corners.size());
    features.keypoints.resize(first + count);
    features.bearings.resize(first + count);
    features.descriptors.resize(first + count);
    const double scale_y = camera.height() / static_cast<double>(level.camera.height());
    const float sigma =
        static_cast<float>(camera.AngleOfPixels(options_.pixel_sigma * level.scale));
#pragma omp parallel for schedule(static)
    for (int i = 0; i < count; ++i) {
      const Corner& corner = corners[i];
      Keypoint& keypoint = features.keypoints[first + i];
      const Eigen::Vector2d pixel(camera.WrapU((corner.x + 0.5 + corner.dx) * level.scale),
                                  (corner.y + 0.5 + corner.dy) * scale_y);
      keypoint.pixel = pixel.cast<float>();
      keypoint.sigma = sigma;
      keypoint.level = static_cast<uint8_t>(l);
      keypoint.score = corner.score;
      features.bearings[first + i] = camera.Bearing(pixel);
      Describe(level, blurred, corner.x, corner.y, &keypoint.angle,
               &features.descriptors[first + i]);
    }
  }
  features.grid = SphereGrid(features.bearings);
  return features;
}

}  // namespace orb360
