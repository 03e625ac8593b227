#include "apps/town/world/landscape/landscape.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "apps/town/image/noise.h"
#include "apps/town/world/landscape/conifer.h"
#include "apps/town/world/landscape/rock.h"
#include "apps/town/world/landscape/undergrowth.h"
#include "apps/town/world/tree.h"

namespace orb360::town {
namespace {

/// Parts of a seed, so that the draws of one part do not affect the others.
enum SeedPart : uint64_t { kKind = 1, kMaterials, kTrail, kTerrain, kModels, kPlaces = 100 };

/// How often things stand: the probability in cells of a grid, everywhere or in patches.
struct Density {
  float cell = 4;       ///< metres
  float chance = 0.5F;  ///< in a cell, where they are
  float patches = 1;    ///< fraction of the area where they are; 1: everywhere
  float reach = 1000;   ///< metres from the trail
  float sunk = 0;       ///< metres below the ground
};

/// What stands in a kind of landscape.
struct Recipe {
  TerrainOptions terrain;
  Density broadleaved, conifers, shrubs, ferns, grass, rocks, boulders, trunks;
  float bole_low = 0;  ///< of broad-leaved trees, metres
  float bole_high = 0.5F;
  float crown_base_low = 1;  ///< of conifers, metres
  float crown_base_high = 5;
  bool is_dry = false;
};

constexpr float kNearTrail = 16;  // metres, within which small plants are seen

Recipe RecipeOf(LandscapeKind kind) {
  switch (kind) {
    case LandscapeKind::kBroadleavedWood:
      return {.terrain = {.hills = 1.2F, .hill_size = 45, .bumps = 0.1F},
              .broadleaved = {3.4F, 0.75F},
              .conifers = {11, 0.3F, 0.6F},
              .shrubs = {1.7F, 0.45F, 0.5F, kNearTrail},
              .ferns = {1.0F, 0.5F, 0.35F, kNearTrail},
              .grass = {0.8F, 0.5F, 0.3F, kNearTrail},
              .rocks = {5, 0.15F, 1, kNearTrail, 0.1F},
              .boulders = {16, 0.2F, 1, 1000, 0.3F},
              .trunks = {9, 0.3F, 1, 30},
              .bole_low = 2,
              .bole_high = 6};
    case LandscapeKind::kConiferWood:
      return {.terrain = {.hills = 1.6F, .hill_size = 50, .bumps = 0.15F},
              .broadleaved = {24, 0.3F},
              .conifers = {2.8F, 0.8F},
              .shrubs = {4, 0.2F, 1, kNearTrail},
              .ferns = {1.1F, 0.5F, 0.3F, kNearTrail},
              .grass = {0.9F, 0.4F, 0.2F, kNearTrail},
              .rocks = {3.5F, 0.2F, 1, kNearTrail, 0.1F},
              .boulders = {14, 0.3F, 1, 1000, 0.3F},
              .trunks = {8, 0.35F, 1, 30},
              .crown_base_low = 2,
              .crown_base_high = 8};
    case LandscapeKind::kHeath:
      return {.terrain = {.hills = 2, .hill_size = 60, .bumps = 0.15F, .mountains = 30},
              .broadleaved = {16, 0.25F},
              .conifers = {13, 0.3F, 0.5F},
              .shrubs = {2.2F, 0.4F, 0.35F, 30},
              .ferns = {1.4F, 0.4F, 0.1F, kNearTrail},
              .grass = {0.75F, 0.6F, 0.6F, kNearTrail},
              .rocks = {3, 0.25F, 0.5F, 24, 0.1F},
              .boulders = {13, 0.35F, 1, 1000, 0.3F},
              .trunks = {30, 0.3F, 1, 40},
              .crown_base_low = 0.4F,
              .crown_base_high = 2,
              .is_dry = true};
    case LandscapeKind::kRockyHills:
      break;
  }
  return {.terrain = {.hills = 3, .hill_size = 50, .bumps = 0.35F, .mountains = 70},
          .broadleaved = {30, 0.2F},
          .conifers = {10, 0.3F, 0.5F},
          .shrubs = {3, 0.35F, 0.3F, 30},
          .ferns = {3, 0.2F, 0.1F, kNearTrail},
          .grass = {0.9F, 0.5F, 0.35F, kNearTrail},
          .rocks = {1.3F, 0.4F, 0.6F, 24, 0.1F},
          .boulders = {5, 0.45F, 0.7F, 1000, 0.35F},
          .trunks = {25, 0.3F, 1, 40},
          .crown_base_low = 0.4F,
          .crown_base_high = 2,
          .is_dry = true};
}

GroundMaterials GroundOf(LandscapeKind kind, const LandscapeMaterials& m) {
  switch (kind) {
    case LandscapeKind::kBroadleavedWood:
      return {m.trail, m.leaf_litter, m.moss, m.moss};
    case LandscapeKind::kConiferWood:
      return {m.trail, m.needle_floor, m.rocks[0], m.moss};
    case LandscapeKind::kHeath:
      return {m.trail, m.heath, m.rocks[0], m.grass};
    case LandscapeKind::kRockyHills:
      break;
  }
  return {m.trail, m.heath, m.rocks[0], m.rocks[1]};
}

/// Places instances of models.
class Planter {
 public:
  Planter(const Terrain& terrain, const Trail& trail, float reach, Scenery* scenery)
      : terrain_(&terrain), trail_(&trail), reach_(reach), scenery_(scenery) {}

  /// Scatters models over the ground. The trail is kept free. The models' openness is judged from
  /// `lookout` metres above the ground.
  void Scatter(std::vector<Mesh> models, const Density& density, float lookout, Random random) {
    const auto first = static_cast<uint32_t>(scenery_->models.size());
    std::vector<float> widths;
    for (const Mesh& model : models) widths.push_back(LowWidth(model, density.sunk));
    const auto seed = static_cast<uint32_t>(random.Next());
    const int cells = static_cast<int>(2 * reach_ / density.cell);
    for (int i = 0; i < cells * cells; ++i) {
      const Vector2f cell(static_cast<float>(i % cells), static_cast<float>(i / cells));
      const auto x = static_cast<float>(random.Uniform(0.1, 0.9));
      const auto y = static_cast<float>(random.Uniform(0.1, 0.9));
      const bool is_there = random.Chance(density.chance);
      const auto turn = static_cast<float>(random.Uniform(0, 2 * std::numbers::pi));
      const auto kind = static_cast<size_t>(random.Int(static_cast<int>(models.size())));
      const Vector2f p = density.cell * (cell + Vector2f(x, y)) - Vector2f(reach_, reach_);
      if (!is_there || p.norm() > reach_ || !IsInPatch(p, density.patches, seed)) continue;
      const float away = trail_->Distance(p);
      if (away > density.reach || away < widths[kind] + kFreeWidth) continue;
      Instance instance;
      instance.model = first + static_cast<uint32_t>(kind);
      instance.world_from_model = Eigen::Translation3f(p.x(), p.y(), terrain_->Height(p)) *
                                  Eigen::AngleAxisf(turn, Vector3f::UnitZ()) *
                                  Eigen::Translation3f(0, 0, -density.sunk);
      instance.lookout = lookout;
      scenery_->instances.push_back(instance);
    }
    for (Mesh& model : models) scenery_->models.push_back(std::move(model));
  }

 private:
  /// Returns the largest distance from the axis to what is so low that it would be in the way. On
  /// slopes the trail may be higher than the ground below a model.
  static float LowWidth(const Mesh& model, float sunk) {
    constexpr float kSlope = 1;  // metres
    float width = 0;
    for (const Vector3f& p : model.positions)
      if (p.z() - sunk < kFreeHeight + kSlope) width = std::max(width, p.head<2>().norm());
    return width;
  }
  static bool IsInPatch(const Vector2f& p, float fraction, uint32_t seed) {
    if (fraction >= 1) return true;
    constexpr float kSize = 128;  // metres, of the tile; patches are some 10 m wide
    const float noise = TiledFbm(p.x() / kSize, p.y() / kSize, 12, 3, seed);
    return noise > 0.9F * (0.5F - fraction);
  }

  const Terrain* terrain_;
  const Trail* trail_;
  float reach_;
  Scenery* scenery_;
};

std::vector<Mesh> MakeModels(int count, const Random& random,
                             const std::function<Mesh(Random)>& make) {
  std::vector<Mesh> models;
  for (int i = 0; i < count; ++i) models.push_back(make(random.Fork(static_cast<uint64_t>(i))));
  return models;
}

}  // namespace

LandscapeKind KindOfLandscape(uint64_t seed) {
  return static_cast<LandscapeKind>(Random(seed).Fork(kKind).Int(kLandscapeKinds));
}

Landscape BuildLandscape(uint64_t seed) {
  return BuildLandscape(seed, KindOfLandscape(seed),
                        PaintLandscapeMaterials(Random(seed).Fork(kMaterials)));
}

Landscape BuildLandscape(uint64_t seed, LandscapeKind kind, LandscapeMaterials materials) {
  const Random random = Random(seed).Fork(78);
  Random draw = random.Fork(kTerrain);
  Recipe recipe = RecipeOf(kind);
  recipe.terrain.seed = static_cast<uint32_t>(draw.Next());
  recipe.terrain.hills *= static_cast<float>(draw.Uniform(0.5, 1.3));
  Landscape result{
      Trail(static_cast<float>(draw.Uniform(11, 22)), random.Fork(kTrail)), recipe.terrain, {}};
  const Terrain terrain(result.trail, recipe.terrain);
  constexpr float kAround = 42;  // metres of fine ground and of plants around the trail
  const float reach = result.trail.reach() + kAround;
  MeshBuilder builder(materials);
  terrain.AddGround(reach, GroundOf(kind, materials), builder);
  Scenery& scenery = result.scenery;
  scenery.fixed = std::move(builder.mesh());

  Planter planter(terrain, result.trail, reach, &scenery);
  const Random models = random.Fork(kModels);
  const auto scatter = [&](uint64_t part, int count, const Density& density, float lookout,
                           const std::function<Mesh(Random)>& make) {
    planter.Scatter(MakeModels(count, models.Fork(part), make), density, lookout,
                    random.Fork(kPlaces + part));
  };
  scatter(1, 6, recipe.broadleaved, 8, [&](Random r) {
    const auto bole = static_cast<float>(r.Uniform(recipe.bole_low, recipe.bole_high));
    return MakeTree(materials, r, bole);
  });
  scatter(2, 6, recipe.conifers, 9, [&](Random r) {
    const auto height = static_cast<float>(r.Uniform(9, 19));
    const ConiferShape shape{
        height,
        std::min(0.6F * height,
                 static_cast<float>(r.Uniform(recipe.crown_base_low, recipe.crown_base_high))),
        static_cast<float>(r.Uniform(1.6, 3)), 0.0115F * height};
    return MakeConifer(materials, shape, r);
  });
  scatter(3, 4, recipe.shrubs, 2, [&](Random r) { return MakeShrub(materials, r); });
  scatter(4, 3, recipe.ferns, 1, [&](Random r) { return MakeFern(materials, r); });
  scatter(5, 5, recipe.grass, 0.8F,
          [&](Random r) { return MakeGrass(materials, recipe.is_dry, r); });
  const auto rock = [&](double low, double high) {
    return [&materials, low, high](Random r) {
      const MaterialId material = r.Pick(std::span<const MaterialId>(materials.rocks));
      const auto radius = static_cast<float>(r.Uniform(low, high));
      return MakeRock(materials, material, radius, r);
    };
  };
  scatter(6, 5, recipe.rocks, 1, rock(0.15, 0.5));
  scatter(7, 4, recipe.boulders, 3, rock(0.7, 2));
  scatter(8, 2, recipe.trunks, 1, [&](Random r) { return MakeFallenTrunk(materials, r); });
  scenery.fixed.PartitionCutouts(materials);
  for (Mesh& model : scenery.models) model.PartitionCutouts(materials);
  scenery.palette = std::move(materials);
  return result;
}

}  // namespace orb360::town
