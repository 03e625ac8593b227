#include "apps/town/world/tessellate.h"

#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "apps/town/world/split_triangle.h"

namespace orb360::town {
namespace {

/// Adds and remembers the vertices at the middles of edges.
class Middles {
 public:
  explicit Middles(Mesh* mesh) : mesh_(mesh) {}

  uint32_t Of(uint32_t a, uint32_t b) {
    if (a > b) std::swap(a, b);
    const uint64_t key = static_cast<uint64_t>(a) << 32 | b;
    const auto [entry, is_new] =
        vertices_.try_emplace(key, static_cast<uint32_t>(mesh_->positions.size()));
    if (is_new) Add(a, b);
    return entry->second;
  }

 private:
  void Add(uint32_t a, uint32_t b) {
    const Vertex& va = mesh_->vertices[a];
    const Vertex& vb = mesh_->vertices[b];
    Vertex middle = va;
    middle.u = 0.5F * (va.u + vb.u);
    middle.v = 0.5F * (va.v + vb.v);
    const Vector3f normal = (va.normal.cast<float>() + vb.normal.cast<float>()).normalized();
    middle.normal = (normal * 127).array().round().cast<int8_t>();
    for (size_t k = 0; k < 4; ++k)
      middle.tint[k] = static_cast<uint8_t>((va.tint[k] + vb.tint[k] + 1) / 2);
    mesh_->positions.push_back(0.5F * (mesh_->positions[a] + mesh_->positions[b]));
    mesh_->vertices.push_back(middle);
  }

  Mesh* mesh_;
  std::unordered_map<uint64_t, uint32_t> vertices_;
};

}  // namespace

void Tessellate(float longest, Mesh* mesh) {
  Middles middles(mesh);
  const auto is_long = [&](uint32_t a, uint32_t b) {
    return (mesh->positions[a] - mesh->positions[b]).squaredNorm() > longest * longest;
  };
  std::vector<Triangle> pending = std::move(mesh->triangles);
  mesh->triangles.clear();
  while (!pending.empty()) {
    const Triangle whole = pending.back();
    pending.pop_back();
    const bool is_split = SplitTriangle(
        whole.vertices, is_long, [&](uint32_t a, uint32_t b) { return middles.Of(a, b); },
        [&](const Corners& corners) {
          Triangle part = whole;
          part.vertices = corners;
          pending.push_back(part);
        });
    if (!is_split) mesh->triangles.push_back(whole);
  }
}

}  // namespace orb360::town
