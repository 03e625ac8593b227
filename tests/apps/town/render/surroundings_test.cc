#include "apps/town/render/surroundings.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(Surroundings, AreGroundBelowHousesAroundAndTheSkyAbove) {
  const Light light = MakeLight("noon", 2);
  const Sky sky(light, 2);
  const Surroundings surroundings(light, sky, 1);
  EXPECT_EQ(surroundings.Radiance({0.6F, 0, -0.8F}), surroundings.Radiance({0, 1, 0}));
  const Vector3f up = Vector3f(0.3F, -0.2F, 0.9F).normalized();
  EXPECT_NEAR((surroundings.Radiance(up) - sky.Radiance(up).cwiseMin(3.0F)).norm(), 0, 1e-6F);
  int darker = 0;
  constexpr int kDirections = 64;
  for (int i = 0; i < kDirections; ++i) {
    const float angle = 6.2831853F * static_cast<float>(i) / kDirections;
    const Vector3f d = Vector3f(std::cos(angle), std::sin(angle), 0.15F).normalized();
    const Vector3f radiance = surroundings.Radiance(d);
    EXPECT_GT(radiance.minCoeff(), 0);
    if (radiance.sum() < sky.Radiance(d).sum()) ++darker;
  }
  EXPECT_GT(darker, kDirections / 2);  // most of the horizon is built over
}

}  // namespace
}  // namespace orb360::town
