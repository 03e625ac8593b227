#include "apps/town/import/quake_faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "apps/town/world/split_triangle.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Largest distance of the triangles of a patch from it, in units (about 8 mm).
constexpr float kChordError = 0.25F;
constexpr int kMaxSegments = 64;  // of a Bezier curve

/// Returns the weighted sum of vertices.
template <size_t N>
QuakeVertex Mix(const std::array<const QuakeVertex*, N>& vertices,
                const std::array<float, N>& weights) {
  QuakeVertex sum{Eigen::Vector3f::Zero(), Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(),
                  Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  for (size_t i = 0; i < N; ++i) {
    sum.position += weights[i] * vertices[i]->position;
    sum.uv += weights[i] * vertices[i]->uv;
    sum.light_uv += weights[i] * vertices[i]->light_uv;
    sum.normal += weights[i] * vertices[i]->normal;
    sum.colour += weights[i] * vertices[i]->colour;
  }
  return sum;
}

/// Adds a triangle in the orientation that its normals ask for, unless it has no area. Quake lists
/// corners clockwise.
void AddTriangle(uint32_t a, uint32_t b, uint32_t c, FaceMesh* mesh) {
  const auto& v = mesh->vertices;
  const Eigen::Vector3f normal =
      (v[b].position - v[a].position).cross(v[c].position - v[a].position);
  if (!(normal.squaredNorm() > 0)) return;
  const bool is_front = normal.dot(v[a].normal + v[b].normal + v[c].normal) > 0;
  mesh->triangles.push_back(is_front ? std::array{a, b, c} : std::array{a, c, b});
}

/// The control points of a patch.
class Patch {
 public:
  Patch(const QuakeMap& map, const QuakeFace& face)
      : points_(&map.vertices[face.first_vertex]),
        width_(face.patch_width),
        height_(face.patch_height) {}

  const QuakeVertex& At(size_t x, size_t y) const { return points_[y * width_ + x]; }

  /// Returns the parameters of the columns (or rows) of vertices: the whole part counts curves, the
  /// fraction is the parameter of the curve. All rows have the same columns.
  std::vector<float> Lines(bool along_x) const {
    const size_t along = along_x ? width_ : height_;
    const size_t across = along_x ? height_ : width_;
    std::vector<float> lines = {0};
    for (size_t first = 0; first + 2 < along; first += 2) {
      float bend = 0;  // the second difference of control points
      for (size_t i = 0; i < across; ++i) {
        const auto p = [&](size_t k) -> const Eigen::Vector3f& {
          return (along_x ? At(first + k, i) : At(i, first + k)).position;
        };
        bend = std::max(bend, (p(0) - 2 * p(1) + p(2)).norm());
      }
      // Over a step h of the parameter the chord is within bend * h^2 / 4 of the parabola.
      const int segments = std::clamp(
          static_cast<int>(std::ceil(std::sqrt(bend / (4 * kChordError)))), 1, kMaxSegments);
      for (int k = 1; k <= segments; ++k)
        lines.push_back(static_cast<float>(first) / 2 +
                        static_cast<float>(k) / static_cast<float>(segments));
    }
    return lines;
  }

  QuakeVertex Evaluate(float u, float v) const {
    const size_t x = 2 * std::min(static_cast<size_t>(u), (width_ - 3) / 2);
    const size_t y = 2 * std::min(static_cast<size_t>(v), (height_ - 3) / 2);
    const std::array<float, 3> along = Weights(u - static_cast<float>(x) / 2);
    const std::array<float, 3> down = Weights(v - static_cast<float>(y) / 2);
    std::array<const QuakeVertex*, 9> vertices{};
    std::array<float, 9> weights{};
    for (size_t j = 0; j < 3; ++j) {
      for (size_t i = 0; i < 3; ++i) {
        vertices[3 * j + i] = &At(x + i, y + j);
        weights[3 * j + i] = along[i] * down[j];
      }
    }
    return Mix(vertices, weights);
  }

 private:
  static std::array<float, 3> Weights(float t) {
    return {(1 - t) * (1 - t), 2 * t * (1 - t), t * t};
  }

  const QuakeVertex* points_;
  size_t width_;
  size_t height_;
};

FaceMesh Tessellate(const Patch& patch) {
  FaceMesh mesh;
  const std::vector<float> columns = patch.Lines(true);
  const std::vector<float> rows = patch.Lines(false);
  for (const float v : rows)
    for (const float u : columns) mesh.vertices.push_back(patch.Evaluate(u, v));
  const auto index = [&](size_t x, size_t y) {
    return static_cast<uint32_t>(y * columns.size() + x);
  };
  for (size_t y = 0; y + 1 < rows.size(); ++y) {
    for (size_t x = 0; x + 1 < columns.size(); ++x) {
      AddTriangle(index(x, y), index(x + 1, y), index(x, y + 1), &mesh);
      AddTriangle(index(x + 1, y), index(x + 1, y + 1), index(x, y + 1), &mesh);
    }
  }
  return mesh;
}

}  // namespace

FaceMesh TrianglesOf(const QuakeMap& map, const QuakeFace& face) {
  if (face.kind == QuakeFaceKind::kBillboard) return {};
  if (face.kind == QuakeFaceKind::kPatch) return Tessellate(Patch(map, face));
  FaceMesh mesh;
  const auto first = map.vertices.begin() + static_cast<std::ptrdiff_t>(face.first_vertex);
  mesh.vertices.assign(first, first + static_cast<std::ptrdiff_t>(face.vertex_count));
  for (size_t i = 0; i < face.index_count; i += 3) {
    const uint32_t* corners = &map.indices[face.first_index + i];
    AddTriangle(corners[0], corners[1], corners[2], &mesh);
  }
  return mesh;
}

void DivideForLight(float longest, size_t max_triangles, FaceMesh* mesh) {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
  const auto is_long = [&](uint32_t a, uint32_t b) {
    const QuakeVertex& p = mesh->vertices[a];
    const QuakeVertex& q = mesh->vertices[b];
    constexpr float kPixel = 1.0F / kLightPageSide;
    return (p.position - q.position).squaredNorm() > longest * longest &&
           (p.light_uv - q.light_uv).squaredNorm() > kPixel * kPixel;
  };
  const auto middle_of = [&](uint32_t a, uint32_t b) {
    const auto [entry, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(mesh->vertices.size()));
    if (is_new) {
      const QuakeVertex middle = Mix<2>({&mesh->vertices[a], &mesh->vertices[b]}, {0.5F, 0.5F});
      mesh->vertices.push_back(middle);
    }
    return entry->second;
  };
  std::vector<Corners> open = std::exchange(mesh->triangles, {});
  while (!open.empty()) {
    if (open.size() + mesh->triangles.size() > max_triangles)
      throw UserError("its surfaces are so large that more than " + std::to_string(max_triangles) +
                      " triangles would be needed for its light");
    const Corners whole = open.back();
    open.pop_back();
    const bool is_split = SplitTriangle(whole, is_long, middle_of,
                                        [&](const Corners& part) { open.push_back(part); });
    if (!is_split) mesh->triangles.push_back(whole);
  }
}

}  // namespace orb360::town
