#include "slam/pipeline/lens_distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/statistics.h"

namespace orb360 {
namespace {

// Number of standard deviations and of steps from which a distance is certain.
constexpr double kMinSigmas = 5.0;
constexpr int kMinSteps = 12;
// Two steps to one keyframe share its image, so that they count as one.
constexpr double kSharedImage = 2.0;
// Least change of the distance for which steps are measured anew, in its standard deviations.
constexpr double kMinChange = 2.0;

/// Weighted sums over steps.
struct Sums {
  int count = 0;
  double information = 0;
  double value = 0;
  double square = 0;

  void Add(const Map& map) {
    for (const KeyframeId id : map.KeyframeIds()) {
      for (const GroundStepFrom& step : map.keyframe(id).ground_steps) {
        const LensDistance& seen = step.lens_distance;
        if (!(seen.sigma > 0)) continue;
        const double weight = 1 / (kSharedImage * seen.sigma * seen.sigma);
        ++count;
        information += weight;
        value += weight * seen.value;
        square += weight * seen.value * seen.value;
      }
    }
  }

  EstimatedLensDistance Mean() const {
    if (count < 2) return {};
    const double mean = value / information;
    // Birge's ratio: steps that contradict each other are less certain.
    const double chi_square = kSharedImage * (square - mean * value) / (count - 1);
    const double sigma = std::sqrt(std::max(1.0, chi_square) / information);
    return {{mean, sigma}, count >= kMinSteps && std::abs(mean) > kMinSigmas * sigma};
  }
};

}  // namespace

EstimatedLensDistance EstimateLensDistance(std::span<const Map> maps) {
  Sums sums;
  for (const Map& map : maps) sums.Add(map);
  return sums.Mean();
}

double AssumedLensDistance(const Map& map) {
  for (KeyframeId id = map.keyframe_end() - 1; id >= 0; --id) {
    if (!map.HasKeyframe(id) || map.keyframe(id).ground_steps.empty()) continue;
    return map.keyframe(id).ground_steps.front().assumed_lens_distance;
  }
  return 0;
}

double CorrectForLenses(std::span<const Map> finished, Map* map) {
  Sums sums;
  for (const Map& other : finished) sums.Add(other);
  sums.Add(*map);
  const EstimatedLensDistance estimated = sums.Mean();
  const LensDistance& distance = estimated.distance;
  const double difference = distance.value - AssumedLensDistance(*map);
  if (!estimated.is_certain || std::abs(difference) < kMinChange * distance.sigma) return 1;
  std::vector<double> factors;
  bool is_of_this_run = true;
  for (const KeyframeId id : map->KeyframeIds()) {
    Keyframe& keyframe = map->keyframe(id);
    is_of_this_run = is_of_this_run && keyframe.IsOfThisRun();
    for (GroundStepFrom& step : keyframe.ground_steps) {
      const double change = RatioWith(distance.value, step) - step.ratio;
      // The point half-way is half a step ahead of the first camera and behind the second one.
      step.point1 += 0.5 * change * step.direction1;
      step.point2 -= 0.5 * change * step.direction2;
      factors.push_back((step.ratio + change) / step.ratio);
      step.ratio += change;
      step.assumed_lens_distance = distance.value;
    }
  }
  return is_of_this_run && !factors.empty() ? Median(factors) : 1;
}

}  // namespace orb360
