#include "apps/town/world/tree.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "apps/town/world/hedge.h"

namespace orb360::town {
namespace {

/// Returns a direction with a uniform distribution over the sphere.
Vector3f RandomDirection(Random& random) {
  const auto z = static_cast<float>(random.Uniform(-1, 1));
  const auto angle = static_cast<float>(random.Uniform(0, 2 * std::numbers::pi));
  const float radius = std::sqrt(1 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Adds a square card with leaves, whose twig is at `root`, lit as part of a crown whose surface
/// faces `outward` there.
void AddLeafCard(MeshBuilder& b, MaterialId leaves, const Vector3f& root, const Vector3f& along,
                 float size, const Vector3f& outward, Random& random) {
  const Vector3f up = along.normalized();
  const Vector3f across = (up.cross(RandomDirection(random)) + Vector3f(1e-3F, 0, 0)).normalized();
  std::array<uint32_t, 4> index{};
  for (size_t i = 0; i < 4; ++i) {
    const float u = i == 1 || i == 2 ? 1.0F : 0.0F;
    const float v = i >= 2 ? 1.0F : 0.0F;
    const Vector3f corner = root + size * ((u - 0.5F) * across + v * up);
    index[i] = b.AddVertex(corner, (outward + 0.35F * RandomDirection(random)).normalized(), u, v);
  }
  b.AddTriangle(leaves, index[0], index[1], index[2]);
  b.AddTriangle(leaves, index[0], index[2], index[3]);
}

/// Growth parameters of a kind of tree; lengths in metres.
struct Species {
  float trunk_low, trunk_high;  ///< range of the trunk's length
  float spread;                 ///< how far branches lean from their parent's direction
  float rise;                   ///< how strongly they turn upwards
  float shortening;             ///< of a branch against its parent, on average
  float leaf_size;              ///< side of a card of leaves
  Rgba leaf_tint;
  Rgba bark_tint;
};

constexpr std::array<Species, 5> kSpecies = {{
    // lime, plane, poplar, birch, maple turning red
    {2.2F, 3.0F, 1.0F, 0.35F, 0.68F, 0.95F, {0.8F, 0.9F, 0.7F, 1}, {0.8F, 0.8F, 0.8F, 1}},
    {2.8F, 3.4F, 1.15F, 0.25F, 0.74F, 1.1F, {0.9F, 0.9F, 0.75F, 1}, {1, 1, 0.9F, 1}},
    {2.4F, 2.8F, 0.42F, 1.1F, 0.86F, 0.85F, {0.7F, 0.82F, 0.7F, 1}, {0.7F, 0.7F, 0.7F, 1}},
    {2.6F, 3.4F, 0.8F, 0.45F, 0.66F, 0.7F, {0.95F, 0.95F, 0.7F, 1}, {1, 1, 1, 1}},
    {1.9F, 2.4F, 0.95F, 0.4F, 0.7F, 0.9F, {1, 0.62F, 0.5F, 1}, {0.7F, 0.65F, 0.6F, 1}},
}};

/// Adds a branch with its branches, down to `levels`, and collects the ends of the last ones.
void Grow(MeshBuilder& b, const Species& species, const Vector3f& base, const Vector3f& direction,
          float length, float radius, int levels, Random& random, std::vector<Vector3f>* tips) {
  const Vector3f middle = base + 0.5F * length * direction;
  const Vector3f bent =
      (direction + 0.25F * RandomDirection(random) + Vector3f(0, 0, 0.15F)).normalized();
  const Vector3f end = middle + 0.5F * length * bent;
  b.AddTube(b.materials().bark, base, middle, radius, 0.8F * radius, levels > 2 ? 9 : 5);
  b.AddTube(b.materials().bark, middle, end, 0.8F * radius, 0.55F * radius, levels > 2 ? 9 : 5);
  if (levels <= 2) tips->push_back(middle);
  tips->push_back(end);
  if (levels <= 1) return;
  const int children = 3 + random.Int(2);
  for (int i = 0; i < children; ++i) {
    Vector3f side = RandomDirection(random);
    side.z() = species.rise + 0.5F * std::abs(side.z());
    const Vector3f child = (0.55F * bent + species.spread * side.normalized()).normalized();
    const auto ratio = static_cast<float>(random.Uniform(-0.12, 0.12)) + species.shortening;
    Grow(b, species, i % 2 == 0 ? end : Vector3f(0.35F * middle + 0.65F * end), child,
         length * ratio, 0.5F * radius, levels - 1, random, tips);
  }
}

}  // namespace

Mesh MakeTree(const Materials& materials, Random random, float bole) {
  MeshBuilder b(materials);
  std::vector<Vector3f> tips;
  const Species& species = random.Pick(std::span<const Species>(kSpecies));
  const auto trunk = static_cast<float>(random.Uniform(species.trunk_low, species.trunk_high));
  b.set_tint(species.bark_tint);
  const auto radius = static_cast<float>(random.Uniform(0.12, 0.2));
  if (bole > 0)
    b.AddTube(materials.bark, {0, 0, -0.3F}, {0, 0, bole - 0.3F}, 1.3F * radius, radius, 9);
  Grow(b, species, {0, 0, bole - 0.3F}, Vector3f::UnitZ(), trunk, radius, 4, random, &tips);
  Vector3f centre = Vector3f::Zero();
  for (const Vector3f& tip : tips) centre += tip / static_cast<float>(tips.size());
  const MaterialId leaves = random.Pick(std::span<const MaterialId>(materials.leaves));
  const auto yellow = static_cast<float>(random.Uniform(0.8, 1.0));
  for (const Vector3f& tip : tips) {
    for (int i = 0; i < 5; ++i) {
      const Vector3f outward = (tip - centre + Vector3f(0, 0, 0.4F)).normalized();
      const auto shade = static_cast<float>(random.Uniform(0.6, 1.0));
      const Rgba& tint = species.leaf_tint;
      b.set_tint({shade * yellow * tint.r, shade * tint.g, shade * tint.b, 1});
      AddLeafCard(b, leaves, tip + 0.15F * RandomDirection(random),
                  RandomDirection(random) + 0.6F * outward,
                  species.leaf_size * static_cast<float>(random.Uniform(0.65, 1.05)), outward,
                  random);
    }
  }
  return std::move(b.mesh());
}

Mesh MakeBush(const Materials& materials, Random random) {
  MeshBuilder b(materials);
  AddHedge(b, {{-0.5F, -0.4F, 0}, Vector3f::UnitX(), Vector3f::UnitZ(), -Vector3f::UnitY()}, 1,
           1.1F, 0.8F, random);
  return std::move(b.mesh());
}

}  // namespace orb360::town
