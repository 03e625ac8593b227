#include "apps/town/world/tunnel/tunnel.h"

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "apps/town/world/box_mapping.h"
#include "apps/town/world/landscape/rock.h"
#include "apps/town/world/tessellate.h"
#include "apps/town/world/tunnel/galleries.h"
#include "apps/town/world/tunnel/lining.h"
#include "apps/town/world/tunnel/tunnel_fittings.h"

namespace orb360::town {
namespace {

/// Parts of a seed, so that the draws of one part do not affect the others.
enum SeedPart : uint64_t { kKind = 1, kMaterials, kTrail, kGalleries, kFittings };

constexpr float kFreeWidth = 0.5F;  // metres on either side of the trail's middle

/// Adds rock around galleries: the floor where it is level, walls and roofs elsewhere.
void AddRock(const Galleries& galleries, const LandscapeMaterials& m, const Rgba& tint,
             MeshBuilder& b) {
  const Surface surface = galleries.MakeSurface();
  std::vector<MaterialId> materials;
  for (const auto& [i, k, l] : surface.triangles) {
    const Vector3f& p = surface.positions[i];
    const Vector3f normal = (surface.positions[k] - p).cross(surface.positions[l] - p).normalized();
    const bool is_floor = normal.z() > 0.8F && p.z() < galleries.Floor(p.head<2>()) + 0.25F;
    materials.push_back(is_floor ? m.trail : m.rocks[0]);
  }
  b.set_tint(tint);
  AddBoxMapped(surface, materials, b);
  b.set_tint({1, 1, 1, 1});
}

/// Scatters boulders over the floor of a cave, and stones that hang and stand.
void AddLooseRock(const Galleries& galleries, const GalleryOptions& options, FittingKit& kit) {
  const std::vector<Vector2f>& points = kit.trail.points();
  const size_t count = points.size();
  for (size_t i = 0; i < count; i += 6) {
    if (kit.random.Chance(0.5)) continue;
    const float radius = kit.Draw(0.12, 0.45);
    const float side = kit.random.Chance(0.5) ? 1.0F : -1.0F;
    const float x = side * (kFreeWidth + radius + kit.Draw(0.05, 0.6 * options.half_width));
    const TrailFrame frame = FrameAt(kit.trail, i);
    const Vector3f place = frame.At(x, 0);
    if (kit.trail.Distance(place.head<2>()) < kFreeWidth + radius) continue;
    // It may be a little lower than in the mean.
    const float floor = galleries.Floor(place.head<2>()) - 0.15F * options.roughness;
    const MaterialId material = kit.random.Pick(std::span<const MaterialId>(kit.m.rocks));
    if (kit.random.Chance(0.6)) {
      const Mesh rock = MakeRock(kit.m, material, radius, kit.random.Fork(i));
      kit.b.mesh().Append(rock, Eigen::Affine3f(Eigen::Translation3f(place.x(), place.y(), floor)));
      continue;
    }
    const float shade = kit.Draw(0.5, 0.8);
    kit.b.set_tint({shade, 0.94F * shade, 0.85F * shade, 1});
    const float height = kit.Draw(0.3, 1.4);
    const Vector3f lean(kit.Draw(-0.05, 0.05), kit.Draw(-0.05, 0.05), height);
    const Vector3f foot(place.x(), place.y(), floor - 0.1F);
    kit.b.AddTube(material, foot, foot + 0.3F * lean, 0.7F * radius, 0.45F * radius, 10);
    kit.b.AddTube(material, foot + 0.3F * lean, foot + lean, 0.45F * radius, 0.08F * radius, 10);
  }
  kit.b.set_tint({1, 1, 1, 1});
}

GalleryOptions DrawGalleries(TunnelKind kind, Random random) {
  const auto draw = [&](double low, double high) {
    return static_cast<float>(random.Uniform(low, high));
  };
  if (kind == TunnelKind::kMine)
    return {draw(1.3, 1.8),  draw(2.7, 3.1),    draw(0.2, 0.7), draw(0.06, 0.14),
            draw(0.1, 0.35), 3 + random.Int(5), random.Int(2)};
  return {draw(1.6, 2.8),  draw(3.2, 4.4),    draw(0.6, 1.2),   draw(0.22, 0.36),
          draw(0.25, 0.6), 2 + random.Int(4), 1 + random.Int(3)};
}

/// Builds into galleries what a mine or a cave that is open to visitors has.
void FitGalleries(TunnelKind kind, const Galleries& galleries, const GalleryOptions& options,
                  FittingKit& kit) {
  const bool is_mine = kind == TunnelKind::kMine;
  const float clear = options.half_width - 4 * options.roughness;
  LampRow row;
  row.spacing = kit.Draw(4.5, 8);
  row.x = kit.Draw(-0.5, 0.5) * clear;
  row.height = is_mine ? 2.3F : kit.Draw(2.4, 2.7);
  row.size = is_mine ? Vector2f(0.12F, 0.12F) : Vector2f(0.3F, 0.12F);
  row.brightness = kit.Draw(0.15, 0.45);
  row.lit_width = 2 * options.half_width;
  row.broken = kit.Draw(0, 0.25);
  AddLampRow(row, kit);
  AddPipe(row.x, row.height + 0.08F, 0.012F, {0.1F, 0.1F, 0.1F, 1}, kit);
  if (!is_mine) {
    AddLooseRock(galleries, options, kit);
    return;
  }
  if (kit.random.Chance(0.75)) AddTimberSets(kit.Draw(1.2, 2.6), std::max(0.9F, clear), 2.25F, kit);
  if (kit.random.Chance(0.7)) AddRails(kit.Draw(0.5, 0.75), kit);
  if (kit.random.Chance(0.5))
    AddPipe(clear - 0.1F, kit.Draw(0.4, 1.6), kit.Draw(0.03, 0.09), {0.35F, 0.3F, 0.28F, 1}, kit);
}

/// Adds a tunnel with a lining of concrete or bricks. Returns the free height.
float AddLined(TunnelKind kind, FittingKit& kit) {
  const LandscapeMaterials& m = kit.m;
  LampRow row;
  float half_width = kit.Draw(0.95, 1.5);
  float springing = kit.Draw(0.8, 1.3);
  float crown = springing + half_width * kit.Draw(0.85, 1);
  std::vector<ProfileStrip> profile;
  if (kind == TunnelKind::kRoad) {
    half_width = kit.Draw(3.4, 4.6);
    springing = kit.Draw(2.2, 3);
    crown = springing + half_width * kit.Draw(0.45, 0.75);
    const float kerb = half_width - kit.Draw(0.8, 1.1);
    const MaterialId road = kit.random.Chance(0.5) ? m.asphalt : m.fresh_asphalt;
    const float stripe = kerb - 0.35F;
    const std::array<ProfileStrip, 9> floor = {{{m.paving, {-half_width, 0.18F}, {-kerb, 0.18F}},
                                                {m.kerb, {-kerb, 0.18F}, {-kerb, 0}},
                                                {road, {-kerb, 0}, {-stripe, 0}},
                                                {m.road_paint, {-stripe, 0}, {-stripe + 0.12F, 0}},
                                                {road, {-stripe + 0.12F, 0}, {stripe - 0.12F, 0}},
                                                {m.road_paint, {stripe - 0.12F, 0}, {stripe, 0}},
                                                {road, {stripe, 0}, {kerb, 0}},
                                                {m.kerb, {kerb, 0}, {kerb, 0.18F}},
                                                {m.paving, {kerb, 0.18F}, {half_width, 0.18F}}}};
    for (const ProfileStrip& strip : floor) {
      profile.push_back(strip);
      // Under the paint, which has worn off in places.
      if (strip.material == m.road_paint)
        profile.push_back({road, strip.from - Vector2f(0, 0.002F), strip.to - Vector2f(0, 0.002F)});
    }
    row = {kit.Draw(5, 10),
           kit.random.Chance(0.5) ? 0 : 0.5F * half_width,
           crown - 0.7F,
           {1.2F, 0.2F},
           kit.Draw(0.2, 0.5),
           2 * half_width,
           0.08F};
  } else {
    const float wet = kit.Draw(0.25, 0.55);
    profile.push_back(
        {m.concrete, {-half_width, 0}, {half_width, 0}, {wet, 0.95F * wet, 0.88F * wet, 1}});
    row = {kit.Draw(4, 8),      0.4F * half_width, crown - 0.35F, {0.25F, 0.12F},
           kit.Draw(0.15, 0.4), 2 * half_width,    0.15F};
  }
  const MaterialId brick = kit.random.Pick(std::span<const MaterialId>(m.bricks));
  const std::array<MaterialId, 4> walls = {m.concrete, brick, m.ashlar, m.plaster};
  const MaterialId wall =
      kind == TunnelKind::kCulvert ? brick : kit.random.Pick(std::span<const MaterialId>(walls));
  const MaterialId arch =
      kind == TunnelKind::kCulvert || kit.random.Chance(0.4) ? wall : m.concrete;
  for (ProfileStrip strip : ArchedProfile(wall, arch, half_width, springing, crown, 14)) {
    const float shade = strip.material == wall ? kit.Draw(0.8, 1) : 0.85F;
    strip.tint = {shade, shade, 0.97F * shade, 1};
    profile.push_back(strip);
  }
  AddLining(kit.trail, profile, kit.b);
  AddLampRow(row, kit);
  const int pipes = 1 + kit.random.Int(4);
  for (int i = 0; i < pipes; ++i) {
    const float grey = kit.Draw(0.1, 0.6);
    const float radius = kit.Draw(0.015, 0.07);
    const float side = kit.random.Chance(0.5) ? 1.0F : -1.0F;
    AddPipe(side * (half_width - radius - 0.02F), kit.Draw(0.4, springing), radius,
            {grey, 0.95F * grey, 0.9F * grey, 1}, kit);
  }
  return std::min(row.height, kind == TunnelKind::kRoad ? springing : crown) - 0.3F;
}

}  // namespace

TunnelKind KindOfTunnel(uint64_t seed) {
  return static_cast<TunnelKind>(Random(seed).Fork(kKind).Int(kTunnelKinds));
}

Tunnel BuildTunnel(uint64_t seed) {
  return BuildTunnel(seed, KindOfTunnel(seed),
                     PaintLandscapeMaterials(Random(seed).Fork(kMaterials)));
}

Tunnel BuildTunnel(uint64_t seed, TunnelKind kind, LandscapeMaterials materials) {
  const Random random = Random(seed).Fork(79);
  Random draw = random.Fork(kTrail);
  const double radius = kind == TunnelKind::kRoad ? draw.Uniform(16, 30) : draw.Uniform(9, 16);
  const bool is_rock = kind == TunnelKind::kMine || kind == TunnelKind::kCave;
  // A lining is swept along the trail: bends must be wider than it.
  const float swing = is_rock ? 1 : 0.4F;
  Tunnel tunnel{Trail(static_cast<float>(radius), draw.Fork(1), swing), {}, {}, 0};
  MeshBuilder builder(materials);
  FittingKit kit{tunnel.trail,
                 [](const Vector2f&) { return 0.0F; },
                 materials,
                 builder,
                 tunnel.scenery.lamps,
                 random.Fork(kFittings)};
  if (is_rock) {
    const GalleryOptions options = DrawGalleries(kind, random.Fork(kGalleries));
    const auto galleries =
        std::make_shared<Galleries>(tunnel.trail, options, random.Fork(kGalleries).Fork(1));
    kit.floor = [galleries](const Vector2f& p) { return galleries->Floor(p); };
    const float shade = kit.Draw(0.45, 0.9);
    AddRock(*galleries, materials, {shade, kit.Draw(0.88, 1) * shade, kit.Draw(0.75, 1) * shade, 1},
            builder);
    FitGalleries(kind, *galleries, options, kit);
    tunnel.head_room = 1.95;
  } else {
    tunnel.head_room = AddLined(kind, kit);
  }
  tunnel.floor = kit.floor;
  Scenery& scenery = tunnel.scenery;
  scenery.fixed = std::move(builder.mesh());
  constexpr float kLongestEdge = 0.5F;  // metres, so that the light of lamps can vary
  Tessellate(kLongestEdge, &scenery.fixed);
  scenery.fixed.PartitionCutouts(materials);
  scenery.palette = std::move(materials);
  return tunnel;
}

}  // namespace orb360::town
