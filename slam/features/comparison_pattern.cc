#include "slam/features/comparison_pattern.h"

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Core>

#include "slam/features/tangent_sampling.h"

namespace orb360 {
namespace {

constexpr double kRadius = TangentSampling::kMaxRadius;

// Each point is drawn from a Gaussian of a fifth of the patch's size (Calonder et al., BRIEF, ECCV
// 2010: the best of their layouts). The generator is fixed: descriptors are part of stored maps.
ComparisonPattern MakeComparisonPattern() {
  constexpr double kSigma = (2 * kRadius + 1) / 5.0;
  constexpr double kMinSeparation = 3.0;  // pixels; nearer points are one after blurring
  std::mt19937 random(360);
  const auto uniform = [&] { return (random() + 0.5) / 4294967296.0; };
  const auto draw = [&] {
    while (true) {  // Box-Muller: the standard library's own distributions differ by vendor
      const double radius = kSigma * std::sqrt(-2.0 * std::log(uniform()));
      const double angle = 2.0 * std::numbers::pi * uniform();
      if (radius <= kRadius) {
        return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
      }
    }
  };
  ComparisonPattern pattern;
  for (int i = 0; i < ComparisonPattern::kPairs;) {
    const Eigen::Vector2f first = draw().cast<float>();
    const Eigen::Vector2f second = draw().cast<float>();
    if ((first - second).norm() < kMinSeparation) continue;
    pattern.first_east[i] = first.x();
    pattern.first_south[i] = first.y();
    pattern.second_east[i] = second.x();
    pattern.second_south[i] = second.y();
    ++i;
  }
  return pattern;
}

MomentPattern MakeMomentPattern() {
  constexpr int kReach = static_cast<int>(kRadius);
  constexpr size_t kBlock = 64;
  MomentPattern pattern;
  for (int south = -kReach; south <= kReach; south += 2) {
    for (int east = -kReach; east <= kReach; east += 2) {
      if (east * east + south * south > kReach * kReach) continue;
      pattern.east.push_back(static_cast<float>(east));
      pattern.south.push_back(static_cast<float>(south));
    }
  }
  while (pattern.east.size() % kBlock != 0) {
    pattern.east.push_back(0.0f);  // weighs nothing
    pattern.south.push_back(0.0f);
  }
  return pattern;
}

}  // namespace

const ComparisonPattern& DescriptorPattern() {
  static const ComparisonPattern kPattern = MakeComparisonPattern();
  return kPattern;
}

const MomentPattern& OrientationPattern() {
  static const MomentPattern kPattern = MakeMomentPattern();
  return kPattern;
}

}  // namespace orb360
