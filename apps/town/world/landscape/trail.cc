#include "apps/town/world/landscape/trail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace orb360::town {

Trail::Trail(float radius, Random random, float swing) {
  constexpr float kPi = std::numbers::pi_v<float>;
  constexpr float kSpacing = 0.25F;
  // A radius for each direction, so that the trail cannot cross itself.
  constexpr std::array<float, 4> kSwings = {0.22F, 0.16F, 0.08F, 0.04F};
  std::array<float, kSwings.size()> phases{};
  for (float& phase : phases) phase = static_cast<float>(random.Uniform(0, 2 * kPi));
  const auto at = [&](float angle) -> Vector2f {
    float factor = 1;
    for (size_t i = 0; i < kSwings.size(); ++i)
      factor += swing * kSwings[i] * std::cos(static_cast<float>(i + 2) * angle + phases[i]);
    return radius * factor * Vector2f(std::cos(angle), std::sin(angle));
  };
  constexpr int kFine = 20000;
  points_.push_back(at(0));
  for (int i = 1; i < kFine; ++i) {
    const Vector2f p = at(2 * kPi * static_cast<float>(i) / kFine);
    if ((p - points_.back()).norm() >= kSpacing) points_.push_back(p);
  }
  for (const Vector2f& p : points_) reach_ = std::max(reach_, p.norm());
}

float Trail::Length() const {
  float length = (points_.front() - points_.back()).norm();
  for (size_t i = 1; i < points_.size(); ++i) length += (points_[i] - points_[i - 1]).norm();
  return length;
}

float Trail::Distance(const Vector2f& p) const {
  float least = std::numeric_limits<float>::max();
  for (size_t i = 0; i < points_.size(); ++i) {
    const Vector2f& a = points_[i];
    const Vector2f side = points_[(i + 1) % points_.size()] - a;
    const float t = std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0F, 1.0F);
    least = std::min(least, (p - a - t * side).squaredNorm());
  }
  return std::sqrt(least);
}

}  // namespace orb360::town
