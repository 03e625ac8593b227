#include "apps/town/world/landscape/rock.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "apps/town/image/noise.h"
#include "apps/town/world/box_mapping.h"

namespace orb360::town {
namespace {

/// Returns a unit sphere: an octahedron whose triangles are divided in four, `times` times.
Surface UnitSphere(int times) {
  Surface sphere;
  sphere.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  sphere.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), 0U);
      if (is_new) {
        entry->second = static_cast<uint32_t>(sphere.positions.size());
        sphere.positions.push_back((sphere.positions[a] + sphere.positions[b]).normalized());
      }
      return entry->second;
    };
    std::vector<std::array<uint32_t, 3>> finer;
    for (const auto& [a, b, c] : sphere.triangles) {
      const uint32_t ab = middle(a, b);
      const uint32_t bc = middle(b, c);
      const uint32_t ca = middle(c, a);
      for (const auto& triangle : {std::array{a, ab, ca}, std::array{ab, b, bc},
                                   std::array{ca, bc, c}, std::array{ab, bc, ca}})
        finer.push_back(triangle);
    }
    sphere.triangles = std::move(finer);
  }
  return sphere;
}

}  // namespace

Mesh MakeRock(const Materials& materials, MaterialId material, float radius, Random random) {
  const auto draw = [&](double low, double high) {
    return static_cast<float>(random.Uniform(low, high));
  };
  Surface rock = UnitSphere(radius > 0.6F ? 4 : 3);
  // Planes cut pieces off, as frost does.
  struct Cut {
    Vector3f normal;
    float distance;
  };
  std::vector<Cut> cuts;
  for (int i = 0; i < 12; ++i) {
    const Vector3f direction(draw(-1, 1), draw(-1, 1), draw(-1, 1));
    cuts.push_back({(direction + Vector3f(0, 0, 1e-3F)).normalized(), draw(0.55, 0.95)});
  }
  const Vector3f stretch(draw(0.75, 1), draw(0.6, 1), draw(0.45, 0.85));
  const auto seed = static_cast<uint32_t>(random.Next());
  for (Vector3f& p : rock.positions) {
    float reach = 1;
    for (const Cut& cut : cuts) {
      const float towards = p.dot(cut.normal);
      if (towards > 0.05F) reach = std::min(reach, cut.distance / towards);
    }
    const float rough = 1 + 0.07F * SpaceFbm(2 * p.x(), 2 * p.y(), 2 * p.z(), 4, seed, 0.55F);
    p = radius * reach * rough * p.cwiseProduct(stretch);
  }
  MeshBuilder b(materials);
  const float shade = draw(0.45, 0.95);
  b.set_tint({shade, 0.98F * shade, draw(0.85, 0.98) * shade, 1});
  const std::vector<MaterialId> all(rock.triangles.size(), material);
  AddBoxMapped(rock, all, b);
  return std::move(b.mesh());
}

}  // namespace orb360::town
