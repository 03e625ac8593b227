#include "apps/town/world/materials.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

const Materials& Painted() {
  static const Materials materials = PaintMaterials(7);  // checks that all colours are numbers
  return materials;
}

TEST(PaintMaterials, EveryTextureHasAnImageOfModerateBrightness) {
  const Materials& materials = Painted();
  for (size_t i = 0; i < materials.textures.size(); ++i) {
    const Texture& texture = materials.textures[i];
    const Rgba mean = texture.Sample(0.5F, 0.5F, 20);
    for (const float channel : {mean.r, mean.g, mean.b}) {
      EXPECT_GE(channel, 0.0F) << i;
      EXPECT_LT(channel, 0.95F) << i;
    }
    EXPECT_GT(mean.r + mean.g + mean.b, 0.005F) << i;
    EXPECT_LE(texture.width(), 1024) << i;
  }
}

TEST(PaintMaterials, CutoutsArePartlyThere) {
  const Materials& materials = Painted();
  for (const Material& material : materials.all) {
    const float coverage = materials.textures[material.texture].Sample(0.5F, 0.5F, 20).a;
    if (material.cutout) {
      EXPECT_GT(coverage, 0.15F) << material.texture;
      EXPECT_LT(coverage, 0.995F) << material.texture;
    }
  }
}

TEST(PaintMaterials, IsTheSameForTheSameSeed) {
  const Materials& a = Painted();
  const Materials b = PaintMaterials(7);
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (size_t i = 0; i < a.textures.size(); ++i) {
    for (const float u : {0.1F, 0.37F, 0.8F})
      EXPECT_EQ(a.textures[i].Sample(u, 0.3F, 0).g, b.textures[i].Sample(u, 0.3F, 0).g) << i;
  }
}

}  // namespace
}  // namespace orb360::town
