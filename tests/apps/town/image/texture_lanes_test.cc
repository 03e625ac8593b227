#include "apps/town/image/texture_lanes.h"

#include <vector>

#include <gtest/gtest.h>

#include "apps/town/image/random.h"
#include "tests/dispatch_targets.h"

namespace orb360::town {
namespace {

Texture Speckled(int width, int height, Random* random) {
  std::vector<Rgba> texels(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (Rgba& texel : texels) {
    const auto channel = [&] { return static_cast<float>(random->Uniform(0, 1)); };
    texel = {channel(), channel(), channel(), channel()};
  }
  return {width, height, texels};
}

TEST(AddSamples, AddsWhatEachTexturesSampleIs) {
  Random random(5);
  const std::array<Texture, 4> textures = {Speckled(64, 64, &random), Speckled(8, 32, &random),
                                           Speckled(128, 2, &random), Speckled(1, 1, &random)};
  for (int round = 0; round < 50; ++round) {
    std::array<const Texture*, kLanes> chosen;
    Lanes u;
    Lanes v;
    Lanes level;
    for (size_t i = 0; i < kLanes; ++i) {
      chosen[i] = &textures[static_cast<size_t>(random.Int(4))];
      u[i] = static_cast<float>(random.Uniform(-3, 3));
      v[i] = static_cast<float>(random.Uniform(-3, 3));
      level[i] = static_cast<float>(random.Uniform(-2, 9));
    }
    ForEachDispatchTarget([&] {
      Lanes3 sum;
      sum.Fill(1);
      AddSamples(chosen, u, v, level, &sum);
      for (size_t i = 0; i < kLanes; ++i) {
        // Places are rounded to 1/256 of a texel, and neighbours may differ by all there is.
        const Rgba colour = chosen[i]->Sample(u[i], v[i], level[i]);
        EXPECT_NEAR(sum.x[i], 1 + colour.r, 0.017F);
        EXPECT_NEAR(sum.y[i], 1 + colour.g, 0.017F);
        EXPECT_NEAR(sum.z[i], 1 + colour.b, 0.017F);
      }
    });
  }
}

}  // namespace
}  // namespace orb360::town
