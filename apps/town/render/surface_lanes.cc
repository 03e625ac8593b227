#include "apps/town/render/surface_lanes.h"

#include <cstring>

namespace orb360::town {
namespace {

void GatherLane(const FrameScene& scene, const Palette& palette, const EyePacket& rays, int lane,
                SurfaceLanes* met) {
  const auto i = static_cast<size_t>(lane);
  const SurfaceHit hit = scene.Resolve(rays.hit(), lane);
  const Triangle& triangle = *hit.triangle;
  const Material& material = palette[triangle.material];
  met->surface[i] =
      static_cast<uint32_t>(scene.ObjectId(rays.hit(), lane)) << 16 | triangle.material;
  met->b[i] = rays.hit().u[lane];
  met->c[i] = rays.hit().v[lane];
  met->range[i] = rays.range(lane);
  met->geometric_normal.Set(i, scene.GeometricNormal(rays.hit(), lane));
  for (size_t corner = 0; corner < 3; ++corner) {
    const uint32_t index = triangle.vertices[corner];
    met->vertices[corner][i] = hit.mesh->vertices[index];
    std::memcpy(met->positions[corner][i].data(), hit.mesh->positions[index].data(),
                sizeof(Vector3f));
  }
  const Texture& texture = palette.textures[material.texture];
  met->texture[i] = &texture;
  met->texels_per_metre[i] = triangle.tiles_per_metre * texture.mean_side();
  met->finish[i] = static_cast<int32_t>(material.finish);
  met->any_mirror |= material.finish == Finish::kGlass || material.finish == Finish::kPaint;
  met->blotches[i] = material.blotches;
  met->blotch_scale[i] = 1 / (kBlotchMetres * material.tiles_per_metre);
  met->any_blotches |= material.blotches > 0;
  const std::vector<Vector3f>& irradiance = hit.mesh->irradiance;
  met->is_baked[i] = irradiance.empty() ? 0 : 1;
  met->irradiance.Set(i, Vector3f::Zero());
  if (!irradiance.empty()) {
    met->any_baked = true;
    met->irradiance.Set(i, (1 - met->b[i] - met->c[i]) * irradiance[triangle.vertices[0]] +
                               met->b[i] * irradiance[triangle.vertices[1]] +
                               met->c[i] * irradiance[triangle.vertices[2]]);
  }
  met->openness[i] = 1;
  met->paint.Set(i, Vector3f::Ones());
  if (hit.instance == nullptr) return;
  met->openness[i] = hit.instance->openness;
  const Rgba& tint = hit.instance->tint;
  if (material.finish == Finish::kPaint) met->paint.Set(i, {tint.r, tint.g, tint.b});
  if (!met->any_turned) {
    for (size_t k = 0; k < 9; ++k) met->rotation[k].fill(k % 4 == 0 ? 1.0F : 0.0F);
    met->any_turned = true;
  }
  const auto& rotation = hit.instance->world_from_model.linear();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      met->rotation[static_cast<size_t>(3 * row + column)][i] = rotation(row, column);
  }
}

void RepeatLane(size_t from, size_t to, SurfaceLanes* met) {
  for (Lanes* lanes : {&met->b, &met->c, &met->range, &met->texels_per_metre, &met->openness,
                       &met->blotches, &met->blotch_scale, &met->is_baked})
    (*lanes)[to] = (*lanes)[from];
  for (Lanes3* lanes : {&met->geometric_normal, &met->paint, &met->irradiance})
    lanes->Set(to, lanes->At(from));
  if (met->any_turned) {
    for (Lanes& element : met->rotation) element[to] = element[from];
  }
  for (size_t corner = 0; corner < 3; ++corner) {
    met->vertices[corner][to] = met->vertices[corner][from];
    met->positions[corner][to] = met->positions[corner][from];
  }
  met->texture[to] = met->texture[from];
  met->finish[to] = met->finish[from];
}

}  // namespace

bool Gather(const FrameScene& scene, const Palette& palette, const EyePacket& rays,
            SurfaceLanes* met) {
  int first_hit = 0;
  while (first_hit < kLanes && !rays.Hits(first_hit)) ++first_hit;
  if (first_hit == kLanes) return false;
  met->any_turned = met->any_blotches = met->any_baked = met->any_mirror = false;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (rays.Hits(lane)) GatherLane(scene, palette, rays, lane, met);
  }
  for (size_t i = 0; i < kLanes; ++i) {
    met->hits[i] = rays.Hits(static_cast<int>(i));
    if (met->hits[i]) continue;
    met->surface[i] = 0;
    RepeatLane(static_cast<size_t>(first_hit), i, met);
  }
  return true;
}

}  // namespace orb360::town
