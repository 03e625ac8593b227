#include "apps/town/render/shading.h"

#include <algorithm>
#include <cmath>

namespace orb360::town {
namespace {

constexpr uint64_t kSkyline = 1;      // seed of the mirrored houses
constexpr float kBlotchTile = 31.0F;  // metres across which the blotches repeat

float Pow5(float x) { return x * x * x * x * x; }

/// Mip level at which `tiles` of a texture, the geometric mean of both directions, are one texel.
float Level(const Texture& texture, float tiles) {
  return FastLog2(std::max(tiles * texture.mean_side(), 1e-6F));
}

}  // namespace

Vector2f TextureCoordinates(const SurfaceHit& hit, float b, float c) {
  const Vertex& va = hit.mesh->vertices[hit.triangle->vertices[0]];
  const Vertex& vb = hit.mesh->vertices[hit.triangle->vertices[1]];
  const Vertex& vc = hit.mesh->vertices[hit.triangle->vertices[2]];
  const float a = 1 - b - c;
  return {a * va.u + b * vb.u + c * vc.u, a * va.v + b * vb.v + c * vc.v};
}

TextureMapping MapTexture(const SurfaceHit& hit, float b, float c) {
  const auto& [ia, ib, ic] = hit.triangle->vertices;
  const Vertex& va = hit.mesh->vertices[ia];
  const Vertex& vb = hit.mesh->vertices[ib];
  const Vertex& vc = hit.mesh->vertices[ic];
  const Vector3f ab = hit.mesh->positions[ib] - hit.mesh->positions[ia];
  const Vector3f ac = hit.mesh->positions[ic] - hit.mesh->positions[ia];
  // The barycentric weights grow along these, the dual basis of the triangle's sides.
  const Vector3f normal = ab.cross(ac);
  const Vector3f grows_b = ac.cross(normal);
  const Vector3f grows_c = normal.cross(ab);
  const float scale = 1 / normal.squaredNorm();
  Vector3f u = scale * ((vb.u - va.u) * grows_b + (vc.u - va.u) * grows_c);
  Vector3f v = scale * ((vb.v - va.v) * grows_b + (vc.v - va.v) * grows_c);
  if (hit.instance != nullptr) {
    u = hit.instance->world_from_model.linear() * u;
    v = hit.instance->world_from_model.linear() * v;
  }
  TextureMapping mapping{TextureCoordinates(hit, b, c), {}};
  mapping.by_way << u.transpose(), v.transpose();
  return mapping;
}

Shader::Shader(const Palette& palette, const Light& light, const Sky& sky)
    : palette_(&palette), light_(&light), sky_(&sky), surroundings_(light, sky, kSkyline) {}

Surface Shader::Describe(const SurfaceHit& hit, float b, float c, const Vector3f& direction,
                         float footprint) const {
  const float a = 1 - b - c;
  const Vertex& va = hit.mesh->vertices[hit.triangle->vertices[0]];
  const Vertex& vb = hit.mesh->vertices[hit.triangle->vertices[1]];
  const Vertex& vc = hit.mesh->vertices[hit.triangle->vertices[2]];
  const Material& material = (*palette_)[hit.triangle->material];
  Surface surface;
  surface.finish = material.finish;
  Vector3f normal =
      a * va.normal.cast<float>() + b * vb.normal.cast<float>() + c * vc.normal.cast<float>();
  if (hit.instance != nullptr) normal = hit.instance->world_from_model.linear() * normal;
  normal *= 1 / normal.norm();  // normalize() divides three times
  float facing = normal.dot(direction);
  if (facing > 0) {
    normal = -normal;
    facing = -facing;
  }
  surface.normal = normal;
  surface.openness = (a * static_cast<float>(va.openness) + b * static_cast<float>(vb.openness) +
                      c * static_cast<float>(vc.openness)) *
                     (1.0F / 255);

  if (hit.instance != nullptr) surface.openness *= hit.instance->openness;

  // A tilted surface stretches the footprint one way by 1/cos: the geometric mean of both ways.
  const float stretched = footprint / std::sqrt(std::max(-facing, 0.04F));
  surface.texture = &palette_->textures[material.texture];
  surface.level = Level(*surface.texture, stretched * hit.triangle->tiles_per_metre);
  surface.tone = (a * Vector3f(va.tint[0], va.tint[1], va.tint[2]) +
                  b * Vector3f(vb.tint[0], vb.tint[1], vb.tint[2]) +
                  c * Vector3f(vc.tint[0], vc.tint[1], vc.tint[2])) *
                 (1.0F / 255);
  surface.tone = surface.tone.cwiseProduct(surface.tone);
  if (material.finish == Finish::kPaint && hit.instance != nullptr) {
    const Rgba& tint = hit.instance->tint;
    surface.tone = surface.tone.cwiseProduct(Vector3f(tint.r, tint.g, tint.b));
  }
  if (material.blotches > 0) {
    const Texture& blotches = palette_->textures[palette_->blotches_texture];
    const float scale = 1 / (kBlotchTile * material.tiles_per_metre);
    const float u = a * va.u + b * vb.u + c * vc.u;
    const float v = a * va.v + b * vb.v + c * vc.v;
    const Rgba blotch =
        blotches.Sample(u * scale, v * scale, 1 + Level(blotches, stretched / kBlotchTile));
    surface.tone *= 1 + material.blotches * (1.6F * (blotch.r - 0.5F) + 0.8F * (blotch.g - 0.5F));
  }
  const float sun_cosine = normal.dot(light_->to_sun);
  surface.sun_cosine = material.finish == Finish::kFoliage
                           ? 0.25F + (sun_cosine > 0 ? 0.55F * sun_cosine : -0.45F * sun_cosine)
                           : std::max(sun_cosine, 0.0F);
  return surface;
}

Vector3f Shader::Colour(const Surface& surface, const Vector2f& uv, float level_offset) {
  const Rgba colour = surface.texture->Sample(uv.x(), uv.y(), surface.level + level_offset);
  return {colour.r, colour.g, colour.b};
}

Vector3f Shader::Radiance(const Surface& surface, const Vector3f& albedo, float sunlit,
                          const Vector3f& direction, float range) const {
  const float up = 0.5F + 0.5F * surface.normal.z();
  const Vector3f ambient = surface.openness * (up * sky_->mean() + (1 - up) * light_->ground) +
                           (1 - surface.openness) * 0.9F * light_->ground;
  const Vector3f light = ambient + sunlit * surface.sun_cosine * light_->sun;
  const Vector3f colour = albedo.cwiseProduct(surface.tone);
  Vector3f radiance = colour.cwiseProduct(light);
  if (surface.finish == Finish::kGlass || surface.finish == Finish::kPaint) {
    const float cosine = -surface.normal.dot(direction);
    const bool glass = surface.finish == Finish::kGlass;
    const float base = glass ? 0.10F : 0.04F;
    const float fresnel = base + (1 - base) * Pow5(1 - std::clamp(cosine, 0.0F, 1.0F));
    const Vector3f mirrored = direction + 2 * cosine * surface.normal;
    const Vector3f reflected = surroundings_.Radiance(mirrored);
    radiance = (1 - fresnel) * (glass ? 0.55F : 1.0F) * radiance + fresnel * reflected;
  } else if (surface.finish == Finish::kLamp) {
    radiance += 0.7F * colour;
  }
  const float clear = std::exp(-range / light_->haze);
  return clear * radiance + (1 - clear) * light_->horizon;
}

}  // namespace orb360::town
