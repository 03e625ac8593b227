#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include <orb360/nn/base/check.h>

namespace orb360 {

/// Options of all robust estimates on bearings. Errors are angles in standard deviations of the
/// bearings' own noise, so that one threshold suits every feature.
struct RansacOptions {
  /// Angular noise (standard deviation in each direction) of a bearing without its own, radians:
  /// one pixel of a panorama 2048 pixels wide.
  double sigma = 0.003;
  /// Correspondences below this many standard deviations are inliers. 3 keeps 99 % of the correct
  /// ones with one or two degrees of freedom.
  double max_error = 3.0;
  /// A model with fewer inliers is rejected. Of 1000 wrong matches about 10 fit any epipolar
  /// geometry by chance.
  int min_inliers = 12;
  /// Sampling ends when a sample without outliers has been drawn with this probability, if the
  /// fraction of correct correspondences is min_inlier_ratio.
  double confidence = 0.999;
  /// Least fraction of correct correspondences that is assumed. 0.4 allows 40 samples of two, 105
  /// of three, and 672 of five.
  double min_inlier_ratio = 0.4;
  /// The same seed gives the same result.
  uint64_t seed = 1;
};

/// Angular noise of each correspondence, radians: a span as long as the data, or an empty one to
/// use RansacOptions::sigma for all.
using Sigmas = std::span<const double>;

/// Tukey's biweight loss, by which models are compared and refined. It grows smoothly to 1 at 1.5
/// times the threshold of inliers, by default 4.5 standard deviations, where a fit is 95 % as
/// efficient as least squares on Gaussian noise. It takes squared errors in standard deviations.
class TukeyLoss {
 public:
  /// `widening` > 1 includes correspondences that are far from a model that is still to be refined.
  explicit TukeyLoss(const RansacOptions& options, double widening = 1.0)
      : is_wide_(widening > 1.0), limit_(std::pow(1.5 * widening * options.max_error, 2)) {}

  bool is_wide() const { return is_wide_; }

  /// Square of the error beyond which the loss is 1.
  double limit() const { return limit_; }
  double Loss(double squared_error) const {
    if (!(squared_error < limit_)) return 1.0;
    const double rest = 1.0 - squared_error / limit_;
    return 1.0 - rest * rest * rest;
  }
  /// Weight of the residual in least squares: the derivative of the loss up to a constant.
  double Weight(double squared_error) const {
    if (!(squared_error < limit_)) return 0.0;
    const double rest = 1.0 - squared_error / limit_;
    return rest * rest;
  }

 private:
  bool is_wide_;
  double limit_;
};

namespace internal {

inline double SigmaOf(Sigmas sigmas, size_t i, const RansacOptions& options) {
  return sigmas.empty() ? options.sigma : sigmas[i];
}

/// SplitMix64 (Steele et al., Fast Splittable Pseudorandom Number Generators, OOPSLA 2014). Unlike
/// the standard library's distributions it gives the same numbers on every platform.
class SampleGenerator {
 public:
  explicit SampleGenerator(uint64_t seed) : state_(seed) {}

  /// Returns `kSize` different indices below `count`, which must not be smaller than kSize.
  template <size_t kSize>
  std::array<int, kSize> Draw(size_t count) {
    std::array<int, kSize> sample;
    for (size_t i = 0; i < kSize; ++i) {
      bool fresh = false;
      while (!fresh) {
        sample[i] = static_cast<int>(((Next() >> 32) * count) >> 32);
        fresh = true;
        for (size_t j = 0; j < i; ++j) fresh = fresh && sample[j] != sample[i];
      }
    }
    return sample;
  }

 private:
  uint64_t Next() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  uint64_t state_;
};

}  // namespace internal

/// Returns the best model for `count` correspondences. Random samples are drawn, and each
/// improvement is refined at once (locally optimized RANSAC), all in one fixed order. Models are
/// compared by the sum of TukeyLoss.
///
/// `solve(sample, consider)` calls `consider(model)` for each model through `kSampleSize` indices.
/// `error(model, i)` is the squared error in standard deviations, exact below TukeyLoss::limit
/// (NaN: an outlier). `refine(model, loss)` is one step towards the least sum of losses. Returns
/// nullopt when there are fewer correspondences than a sample needs or no model was found.
template <typename Model, size_t kSampleSize, typename Solve, typename Error, typename Refine>
std::optional<Model> Ransac(size_t count, const RansacOptions& options, const Solve& solve,
                            const Error& error, const Refine& refine) {
  if (count < kSampleSize) return std::nullopt;
  ORB360_CHECK(options.min_inlier_ratio > 0.0, options.min_inlier_ratio);
  const TukeyLoss loss(options);
  const double inlier_limit = options.max_error * options.max_error;
  std::optional<Model> best;
  double best_loss = std::numeric_limits<double>::infinity();
  // Number of samples after which one is free of outliers with the wanted confidence.
  const auto iterations_for = [&](double inlier_ratio) {
    const double all_right = std::pow(inlier_ratio, kSampleSize);
    return all_right < 1.0 ? std::log(1.0 - options.confidence) / std::log1p(-all_right) : 0.0;
  };
  double iterations_needed = iterations_for(options.min_inlier_ratio);

  const auto is_best = [&](const Model& model) {
    double sum = 0.0;
    int inliers = 0;
    for (size_t i = 0; i < count && sum < best_loss; ++i) {
      const double squared = error(model, i);
      sum += loss.Loss(squared);
      inliers += squared < inlier_limit;
    }
    if (!(sum < best_loss)) return false;
    best = model;
    best_loss = sum;
    const double inlier_ratio = static_cast<double>(inliers) / count;
    iterations_needed = iterations_for(std::max(inlier_ratio, options.min_inlier_ratio));
    return true;
  };
  // A model through few noisy correspondences is far from most others, so the loss starts wide.
  const std::array<TukeyLoss, 4> narrowing = {TukeyLoss(options, 4.0), TukeyLoss(options, 2.0),
                                              loss, loss};
  internal::SampleGenerator generator(options.seed);
  for (int i = 0; i < iterations_needed; ++i) {
    bool improved = false;
    solve(generator.Draw<kSampleSize>(count),
          [&](const Model& model) { improved = is_best(model) || improved; });
    if (!improved) continue;
    Model refined = *best;
    for (const TukeyLoss& step : narrowing) refined = refine(refined, step);
    is_best(refined);
  }
  constexpr int kMaxFinalSteps = 10;
  for (int i = 0; best && i < kMaxFinalSteps && is_best(refine(*best, loss)); ++i) {
  }
  return best;
}

}  // namespace orb360
