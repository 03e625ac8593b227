#include "apps/town/image/texture.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

Texture Checkerboard() {
  return Texture::Paint(64, [](float x, float y) {
    const bool white = (static_cast<int>(x * 64) + static_cast<int>(y * 64)) % 2 == 0;
    return white ? Rgba{1, 1, 1, 1} : Rgba{0, 0, 0, 1};
  });
}

TEST(Texture, SampleAtATexelsCentreIsThatTexel) {
  const Texture ramp = Texture::Paint(16, [](float x, float y) { return Rgba{x, y, 0.25F, 1}; });
  for (int i = 0; i < 16; ++i) {
    const float centre = (static_cast<float>(i) + 0.5F) / 16;
    const Rgba c = ramp.Sample(centre, 0.03125F, 0);
    EXPECT_NEAR(c.r, centre, 0.01F);  // 8 bits of the square root
    EXPECT_NEAR(c.b, 0.25F, 0.005F);
  }
}

TEST(Texture, SampleWraps) {
  const Texture ramp = Texture::Paint(16, [](float x, float y) { return Rgba{x, y, 0, 1}; });
  for (const float shift : {-3.0F, -1.0F, 1.0F, 7.0F}) {
    EXPECT_NEAR(ramp.Sample(0.3F, 0.6F, 0).r, ramp.Sample(0.3F + shift, 0.6F - shift, 0).r, 1e-5F);
  }
}

TEST(Texture, CoarseLevelsKeepTheLinearMean) {
  const Texture board = Checkerboard();
  for (const float level : {1.0F, 3.0F, 6.0F, 20.0F}) {
    EXPECT_NEAR(board.Sample(0.4F, 0.7F, level).r, 0.5F, 0.01F) << level;
  }
}

TEST(Texture, ColourOutsideACutoutDoesNotBleedIn) {
  const Texture half = Texture::Paint(64, [](float x, float) {
    return x < 0.5F ? Rgba{0.5F, 0.5F, 0.5F, 1} : Rgba{0, 0, 0, 0};
  });
  const Rgba mean = half.Sample(0.5F, 0.5F, 6);
  EXPECT_NEAR(mean.r, 0.5F, 0.01F);
  EXPECT_NEAR(mean.a, 0.5F, 0.01F);
  EXPECT_TRUE(half.Covers(0.25F, 0.5F));
  EXPECT_FALSE(half.Covers(0.75F, 0.5F));
}

TEST(Texture, RefusesSidesThatAreNoPowersOfTwo) {
  EXPECT_THROW(Texture(3, 4, std::vector<Rgba>(12)), ContractError);
  EXPECT_THROW(Texture(4, 4, std::vector<Rgba>(15)), ContractError);
}

TEST(Texture, RefusesColoursThatAreNoNumbers) {
  std::vector<Rgba> texels(4);
  texels[2].g = std::nanf("");
  EXPECT_THROW(Texture(2, 2, texels), ContractError);
}

}  // namespace
}  // namespace orb360::town
