#include "apps/town/render/shading.h"

#include "apps/town/image/texture_lanes.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr uint64_t kSkyline = 1;            // seed of the mirrored houses
constexpr float kIndoorReflectance = 0.5F;  // of what mirrors show indoors, lit as they are

}  // namespace

Shader::Shader(const Palette& palette, const Light& light, const Sky& sky)
    : palette_(&palette), light_(&light), sky_(&sky), surroundings_(light, sky, kSkyline) {}

void Shader::Shade(const FrameScene& scene, const EyePacket& rays,
                   std::span<const SampleLanes> samples, float sample_angle, SurfaceLanes* met,
                   SightLanes* sight) const {
  ORB360_CHECK(!samples.empty() && samples.size() <= kMaximumSamples, samples.size());
  const bool any_hit = Gather(scene, *palette_, rays, met);
  const auto number = static_cast<float>(samples.size());
  if (any_hit) {
    DescribedLanes described;
    const Texture& blotches_texture = palette_->textures[palette_->blotches_texture];
    Describe(*met, samples, sample_angle, *light_, blotches_texture.mean_side(), &described, sight);
    Lanes3 albedo;
    albedo.Fill(0);
    for (size_t k = 0; k < samples.size(); ++k) {
      const DescribedLanes::Place& place = described.samples[k];
      AddSamples(met->texture, place.u, place.v, place.level, &albedo);
    }
    for (Lanes* channel : {&albedo.x, &albedo.y, &albedo.z}) {
      for (float& value : *channel) value *= 1 / number;
    }
    Lanes3 blotches;
    if (met->any_blotches) {
      blotches.Fill(0);
      std::array<const Texture*, kLanes> textures;
      textures.fill(&blotches_texture);
      AddSamples(textures, described.blotch.u, described.blotch.v, described.blotch.level,
                 &blotches);
    }
    Lanes3 reflected;
    if (met->any_mirror) {
      reflected.Fill(0);
      for (size_t i = 0; i < kLanes; ++i) {
        const auto finish = static_cast<Finish>(met->finish[i]);
        if (finish == Finish::kGlass || finish == Finish::kPaint)
          reflected.Set(i, met->is_baked[i] > 0
                               ? Vector3f(kIndoorReflectance * met->irradiance.At(i))
                               : surroundings_.Radiance(described.mirrored.At(i)));
      }
    }
    Illuminate(*met, described, albedo, blotches, reflected, *light_, sky_->mean(), sight);
    sight->surface = met->surface;
  } else {
    sight->surface.fill(0);
  }
  for (size_t i = 0; i < kLanes; ++i) {
    if (sight->surface[i] != 0) continue;
    Vector3f sum = Vector3f::Zero();
    for (const SampleLanes& sample : samples)
      sum += sky_->Radiance(sample.direction.At(i)).cwiseMin(kMaximumRadiance / exposure_);
    sight->shade.Set(i, sum / number);
    sight->sun.Set(i, Vector3f::Zero());
  }
  if (exposure_ == 1) return;
  for (Lanes3* radiance : {&sight->shade, &sight->sun}) {
    for (Lanes* channel : {&radiance->x, &radiance->y, &radiance->z}) {
      for (float& value : *channel) value *= exposure_;
    }
  }
}

}  // namespace orb360::town
