#include "apps/town/render/shading.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "apps/town/render/ray_directions.h"
#include "tests/apps/town/plain_materials.h"
#include "tests/dispatch_targets.h"

namespace orb360::town {
namespace {

constexpr float kSampleAngle = 0.001F;
const EquirectangularCamera kCamera(512, 256);
const Light kLight = MakeLight("noon", 1);

const Sky& TheSky() {
  static const Sky sky(kLight, 1);
  return sky;
}

/// A square on the ground, tilted by `slope`, its texture brighter to one side.
Scenery Ramp(float slope, Finish finish, const Rgba& tint) {
  Materials materials = PlainMaterials();
  materials.textures[0] = Texture::Paint(512, [](float x, float y) {
    return Rgba{0.2F + 0.6F * x, 0.5F, 0.2F + 0.6F * y, 1};
  });
  materials.all[0].finish = finish;
  MeshBuilder builder(materials);
  builder.set_tint(tint);
  builder.AddQuad(
      0,
      {Vector3f(-9, -9, 0), Vector3f(9, -9, 18 * slope), Vector3f(9, 9, 18 * slope),
       Vector3f(-9, 9, 0)},
      {Vector2f(0.1F, 0.1F), Vector2f(0.9F, 0.1F), Vector2f(0.9F, 0.9F), Vector2f(0.1F, 0.9F)});
  Scenery scenery;
  scenery.palette = materials;
  scenery.fixed = builder.mesh();
  scenery.fixed.PartitionCutouts(materials);
  return scenery;
}

/// What is seen through a square of pixels; `samples` are those of its pixels.
SightLanes Look(const FrameScene& scene, const Shader& shader, const Vector3f& eye,
                std::span<const SampleLanes> samples) {
  EyePacket rays;
  rays.Trace(scene, eye, samples[0].direction);
  SurfaceLanes met{};
  SightLanes sight;
  shader.Shade(scene, rays, samples, kSampleAngle, &met, &sight);
  return sight;
}

std::vector<SampleLanes> SamplesOfSquare(const EquirectangularCamera& camera, int left, int top) {
  const std::array<std::array<double, 2>, 4> pattern = {
      {{0.1, 0.4}, {0.4, 0.9}, {0.6, 0.1}, {0.9, 0.6}}};
  const RayDirections directions =
      RayDirections::OfPanorama(camera, Eigen::Quaterniond::Identity(), pattern);
  std::vector<SampleLanes> samples(pattern.size());
  for (size_t k = 0; k < samples.size(); ++k) {
    directions.OfSquare(left, top, k, &samples[k].direction);
    samples[k].level_offset.fill(0);
  }
  return samples;
}

TEST(Shade, AMatteSurfaceThrowsBackSkySunAndGround) {
  const Rgba tint{0.64F, 0.36F, 0.81F, 1};
  const Scenery scenery = Ramp(0, Finish::kMatte, tint);
  const RayScene rays(scenery);
  const FrameScene scene(rays, {});
  const Shader shader(scenery.palette, kLight, TheSky());
  const Vector3f eye(0.3F, -0.2F, 2);
  const auto samples = SamplesOfSquare(kCamera, 200, 220);
  ForEachDispatchTarget([&] {
    const SightLanes sight = Look(scene, shader, eye, {samples.data(), 1});
    for (size_t i = 0; i < kLanes; ++i) {
      ASSERT_NE(sight.surface[i], 0U);
      const Vector3f point = eye + sight.way.At(i);
      EXPECT_NEAR(point.z(), 0, 1e-5);
      EXPECT_NEAR(sight.range[i], (point - eye).norm(), 1e-5);
      EXPECT_NEAR(sight.sun_cosine[i], kLight.to_sun.z(), 1e-5);
      const double u = 0.5 + 0.4 * point.x() / 9;
      const double red = (0.2 + 0.6 * u) * tint.r;
      const double clear = std::exp(-sight.range[i] / kLight.haze);
      const double haze = (1 - clear) * kLight.horizon.x();
      // It lies open under the sky, which fills its whole hemisphere.
      EXPECT_NEAR(sight.shade.x[i], clear * red * TheSky().mean().x() + haze, 0.01 * red);
      EXPECT_NEAR(sight.sun.x[i], clear * red * kLight.to_sun.z() * kLight.sun.x(), 0.02 * red);
    }
  });
}

TEST(Shade, PaintMirrorsTheSkyByFresnelsReflectance) {
  const Scenery scenery = Ramp(0, Finish::kPaint, {0, 0, 0, 1});
  const RayScene rays(scenery);
  const FrameScene scene(rays, {});
  const Shader shader(scenery.palette, kLight, TheSky());
  for (const int row : {192, 240}) {  // mirrored well above the roofs
    const auto samples = SamplesOfSquare(kCamera, 200, row);
    ForEachDispatchTarget([&] {
      const SightLanes sight = Look(scene, shader, {0, 0, 0.5F}, {samples.data(), 1});
      for (size_t i = 0; i < kLanes; ++i) {
        const auto& [x, y, z] = samples[0].direction;
        const double fraction = 0.04 + 0.96 * std::pow(1.0 + z[i], 5);
        const double clear = std::exp(-sight.range[i] / kLight.haze);
        const double haze = (1 - clear) * kLight.horizon.y();
        const double sky = TheSky().Radiance({x[i], y[i], -z[i]}).y();
        EXPECT_NEAR(sight.shade.y[i], clear * fraction * sky + haze, 1e-5);
      }
    });
  }
}

TEST(Shade, SamplesPlacedOnAPlaneAreThoseThatTheirOwnRaysMeet) {
  // As part of the world, and as a thing that is turned and moves.
  const Scenery still = Ramp(0.2F, Finish::kMatte, {1, 1, 1, 1});
  Scenery turned;
  turned.palette = still.palette;
  turned.models.push_back(still.fixed);
  Instance instance;
  instance.world_from_model.linear() =
      Eigen::AngleAxisf(2.0F, Vector3f(0.1F, 0.2F, 1).normalized()).toRotationMatrix();
  instance.world_from_model.translation() = Vector3f(0.5F, 0.3F, -0.5F);
  for (const bool moves : {false, true}) {
    const Scenery& scenery = moves ? turned : still;
    const RayScene rays(scenery);
    const FrameScene scene(rays, moves ? std::vector<Instance>{instance} : std::vector<Instance>{});
    const Shader shader(scenery.palette, kLight, TheSky());
    const Vector3f eye(0.3F, -0.2F, 3);
    const auto samples = SamplesOfSquare(EquirectangularCamera(64, 32), 12, 25);
    ForEachDispatchTarget([&] {
      const SightLanes together = Look(scene, shader, eye, samples);
      Lanes red{};
      Lanes blue{};
      for (const SampleLanes& sample : samples) {
        const SightLanes alone = Look(scene, shader, eye, {&sample, 1});
        for (size_t i = 0; i < kLanes; ++i) {
          ASSERT_NE(alone.surface[i], 0U);
          red[i] += 0.25F * alone.shade.x[i];
          blue[i] += 0.25F * alone.shade.z[i];
        }
      }
      for (size_t i = 0; i < kLanes; ++i) {
        EXPECT_NEAR(together.shade.x[i], red[i], 2e-4F);
        EXPECT_NEAR(together.shade.z[i], blue[i], 2e-4F);
      }
      // The image changes over the square by more than that.
      EXPECT_GT(std::abs(together.shade.x[0] - together.shade.x[15]) +
                    std::abs(together.shade.z[0] - together.shade.z[15]),
                5e-3F);
    });
  }
}

TEST(Shade, WhereNothingIsMetIsTheSky) {
  const Scenery scenery = Ramp(0, Finish::kMatte, {1, 1, 1, 1});
  const RayScene rays(scenery);
  const FrameScene scene(rays, {});
  const Shader shader(scenery.palette, kLight, TheSky());
  // Its lower rows meet the ground's edge, 9 m away, its upper ones the sky.
  const auto samples = SamplesOfSquare(kCamera, 128, 140);
  const SightLanes sight = Look(scene, shader, {0, 0, 1.5F}, {samples.data(), 1});
  int skies = 0;
  for (size_t i = 0; i < kLanes; ++i) {
    if (sight.surface[i] != 0) continue;
    ++skies;
    const auto& [x, y, z] = samples[0].direction;
    EXPECT_NEAR(sight.shade.y[i], TheSky().Radiance({x[i], y[i], z[i]}).y(), 1e-6F);
    EXPECT_EQ(sight.sun.y[i], 0);
  }
  EXPECT_GT(skies, 0);
  EXPECT_LT(skies, kLanes);
}

}  // namespace
}  // namespace orb360::town
