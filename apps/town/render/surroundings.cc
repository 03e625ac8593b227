#include "apps/town/render/surroundings.h"

#include <algorithm>
#include <cmath>

#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

constexpr float kBrightest = 3.0F;  // of the mirrored sky: the sun's disc is no use in a mirror
constexpr float kEdge = 0.03F;      // sine of elevation over which the eaves blur

/// A substitute for the azimuth without trigonometry, in [0, 4): once round the diamond |x| + |y| =
/// 1.
float Turn(float x, float y) {
  const float t = y / (std::abs(x) + std::abs(y) + 1e-9F);
  return x >= 0 ? 1 + t : 3 - t;
}

}  // namespace

Surroundings::Surroundings(const Light& light, const Sky& sky, uint64_t seed)
    : sky_(&sky), ground_(0.9F * light.ground) {
  Random random(seed ^ 0x5e77);
  size_t column = 0;
  while (column < kColumns) {
    const size_t end = std::min(kColumns, column + 10 + static_cast<size_t>(random.Int(24)));
    const bool gap = random.Chance(0.12);  // a street leads away
    const float height = gap ? 0.04F : static_cast<float>(random.Uniform(0.22, 0.6));
    const auto shade = static_cast<float>(random.Uniform(0.16, 0.42));
    const Vector3f wall = shade * Vector3f(1, static_cast<float>(random.Uniform(0.75, 1)),
                                           static_cast<float>(random.Uniform(0.6, 0.95)));
    for (; column < end; ++column) {
      const float turn = 4 * (static_cast<float>(column) + 0.5F) / kColumns;
      const float t = turn < 2 ? turn - 1 : 3 - turn;
      const Vector3f d = Vector3f(turn < 2 ? 1 - std::abs(t) : std::abs(t) - 1, t, 0).normalized();
      const float sun = std::max(0.0F, -d.dot(light.to_sun));  // the wall faces the mirror
      const Vector3f lit = 0.5F * sky.mean() + 0.5F * light.ground + 0.8F * sun * light.sun;
      houses_[column] = {height, wall.cwiseProduct(lit)};
    }
  }
}

Vector3f Surroundings::Radiance(const Vector3f& direction) const {
  if (direction.z() <= 0) return ground_;
  const float turn = Turn(direction.x(), direction.y()) * (kColumns / 4.0F);
  const House& house = houses_[static_cast<size_t>(turn) % kColumns];
  const float sky = std::clamp((direction.z() - house.height) / kEdge, 0.0F, 1.0F);
  // The lower part of a wall at the street is darker, because of shops, cars and shade.
  const float lower = 0.55F + 0.45F * std::min(1.0F, direction.z() * 4);
  Vector3f wall = lower * house.radiance;
  if (sky <= 0) return wall;
  return wall + sky * (sky_->Radiance(direction).cwiseMin(kBrightest) - wall);
}

}  // namespace orb360::town
