#include "slam/pipeline/assumed_height.h"

#include <array>
#include <cmath>
#include <vector>

#include "nn/base/statistics.h"
#include <orb360/slam/pipeline/scale_options.h>

namespace orb360 {
namespace {

constexpr double kMaxDistance = 30;  // heights
constexpr size_t kMinLandmarks = 100;
constexpr double kQuantile = 0.9;

// A log-normal distribution of heights, metres.
struct Heights {
  double fraction;  // of all recordings
  double median;
  double sigma;  // of the logarithm
};

// Carriers lie between the roof of a small car (1.4 m) and a stick over the head (2.4 m). The rest
// is anywhere.
constexpr std::array<Heights, 2> kCameras = {
    {{0.97, ScaleOptions::kAssumedHeight, 0.25}, {0.03, 6.0, 1.0}}};
// How far surroundings rise above the ground: hedges, trees, houses, hills. Of 30 recordings of 20
// worlds (docs/results/scale.md).
constexpr double kMedianRise = 12.0;  // metres
constexpr double kRiseSigma = 0.8;    // of the logarithm

// The landmark's height over the ground, in heights of the camera, as the nearest keyframe sees it.
// Empty where that is too far away.
std::optional<double> HeightOf(const Map& map, const Landmark& landmark,
                               const KnownGround& ground) {
  double nearest = kMaxDistance * ground.camera_height;
  std::optional<double> height;
  for (const Observation& observation : landmark.observations) {
    const Eigen::Vector3d offset =
        landmark.position - map.keyframe(observation.keyframe).world_from_camera.translation;
    const double up = ground.up.dot(offset);
    const double distance = (offset - up * ground.up).norm();
    if (!(distance < nearest)) continue;
    nearest = distance;
    height = 1 + up / ground.camera_height;
  }
  return height;
}

}  // namespace

double RiseOfSurroundings(std::span<const Map> maps,
                          std::span<const std::optional<KnownGround>> grounds) {
  std::vector<double> heights;
  for (size_t m = 0; m < maps.size(); ++m) {
    if (!grounds[m]) continue;
    for (LandmarkId id = 0; id < maps[m].landmark_end(); ++id) {
      if (!maps[m].HasLandmark(id)) continue;
      if (const auto height = HeightOf(maps[m], maps[m].landmark(id), *grounds[m])) {
        heights.push_back(*height);
      }
    }
  }
  return heights.size() < kMinLandmarks ? 0.0 : NearestRankQuantile(heights, kQuantile);
}

double AssumedHeightSigma(double rise) {
  // Each kind of camera times the likelihood of the rise is a normal distribution of ln(height).
  double sum = 0;
  double sum_of_squares = 0;
  for (const Heights& heights : kCameras) {
    double weight = heights.fraction;
    double mean = std::log(heights.median / ScaleOptions::kAssumedHeight);
    double variance = heights.sigma * heights.sigma;
    if (rise > 0) {
      const double implied = std::log(kMedianRise / rise / ScaleOptions::kAssumedHeight);
      const double total = variance + kRiseSigma * kRiseSigma;
      weight *= std::exp(-0.5 * (implied - mean) * (implied - mean) / total) / std::sqrt(total);
      mean += variance / total * (implied - mean);
      variance *= kRiseSigma * kRiseSigma / total;
    }
    sum += weight;
    sum_of_squares += weight * (variance + mean * mean);
  }
  return std::sqrt(sum_of_squares / sum);
}

}  // namespace orb360
