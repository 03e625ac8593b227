#include "apps/town/world/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orb360::town {
namespace {

// Square metres. Smaller faces are left out, because they have no direction and are invisible.
constexpr float kSmallestArea = 1e-8F;

}  // namespace

std::array<uint8_t, 4> EncodeTint(const Rgba& tint) {
  const auto channel = [](float x) {
    return static_cast<uint8_t>(std::sqrt(std::clamp(x, 0.0F, 1.0F)) * 255 + 0.5F);
  };
  return {channel(tint.r), channel(tint.g), channel(tint.b), 255};
}

void Mesh::PartitionCutouts(const Palette& palette) {
  const auto first_cutout = std::stable_partition(
      triangles.begin(), triangles.end(),
      [&](const Triangle& triangle) { return !palette[triangle.material].cutout; });
  opaque_count = static_cast<size_t>(first_cutout - triangles.begin());
}

void Mesh::Append(const Mesh& other, const Eigen::Affine3f& mesh_from_other) {
  const auto base = static_cast<uint32_t>(positions.size());
  for (const Vector3f& p : other.positions) positions.push_back(mesh_from_other * p);
  for (Vertex vertex : other.vertices) {
    const Vector3f normal = mesh_from_other.linear() * vertex.normal.cast<float>();
    vertex.normal = (normal.normalized() * 127).array().round().cast<int8_t>();
    vertices.push_back(vertex);
  }
  for (Triangle triangle : other.triangles) {
    for (uint32_t& index : triangle.vertices) index += base;
    triangles.push_back(triangle);
  }
}

uint32_t MeshBuilder::AddVertex(const Vector3f& position, const Vector3f& normal, float u,
                                float v) {
  Vertex vertex;
  vertex.u = u;
  vertex.v = v;
  vertex.normal = (normal * 127).array().round().cast<int8_t>();
  vertex.tint = tint_;
  mesh_.positions.push_back(position);
  mesh_.vertices.push_back(vertex);
  return static_cast<uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::AddTriangle(MaterialId material, uint32_t a, uint32_t b, uint32_t c) {
  const Vector3f ab = mesh_.positions[b] - mesh_.positions[a];
  const Vector3f ac = mesh_.positions[c] - mesh_.positions[a];
  const float area = ab.cross(ac).norm();
  if (area < kSmallestArea) return;
  const Vertex& va = mesh_.vertices[a];
  const Vertex& vb = mesh_.vertices[b];
  const Vertex& vc = mesh_.vertices[c];
  const float uv_area = std::abs((vb.u - va.u) * (vc.v - va.v) - (vc.u - va.u) * (vb.v - va.v));
  mesh_.triangles.push_back({{a, b, c}, material, std::sqrt(uv_area / area)});
}

void MeshBuilder::AddQuad(MaterialId material, const std::array<Vector3f, 4>& corners,
                          const std::array<Vector2f, 4>& uv) {
  const Vector3f across = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
  if (across.norm() < kSmallestArea) return;
  const Vector3f normal = across.normalized();
  std::array<uint32_t, 4> index{};
  for (size_t i = 0; i < 4; ++i) index[i] = AddVertex(corners[i], normal, uv[i].x(), uv[i].y());
  AddTriangle(material, index[0], index[1], index[2]);
  AddTriangle(material, index[0], index[2], index[3]);
}

void MeshBuilder::AddRectangle(MaterialId material, const Panel& panel, float x0, float x1,
                               float z0, float z1, float depth) {
  if (x1 - x0 < 1e-3F || z1 - z0 < 1e-3F) return;
  const float scale = (*materials_)[material].tiles_per_metre;
  const Vector2f low = scale * (texture_origin_ + Vector2f(x0, z0));
  const Vector2f high = scale * (texture_origin_ + Vector2f(x1, z1));
  AddQuad(material,
          {panel.At(x0, z0, depth), panel.At(x1, z0, depth), panel.At(x1, z1, depth),
           panel.At(x0, z1, depth)},
          {low, Vector2f(high.x(), low.y()), high, Vector2f(low.x(), high.y())});
}

void MeshBuilder::AddImage(MaterialId material, const Panel& panel, float x0, float x1, float z0,
                           float z1, float depth) {
  AddQuad(material,
          {panel.At(x0, z0, depth), panel.At(x1, z0, depth), panel.At(x1, z1, depth),
           panel.At(x0, z1, depth)},
          {Vector2f(0, 0), Vector2f(1, 0), Vector2f(1, 1), Vector2f(0, 1)});
}

void MeshBuilder::AddFace(MaterialId material, const Vector3f& a, const Vector3f& b,
                          const Vector3f& c, const Vector3f& d) {
  const Vector3f along =
      (b - a).squaredNorm() > 1e-8F ? (b - a).normalized() : (c - d).normalized();
  const Vector3f normal = (c - a).cross(d - b).normalized();
  const Vector3f across = normal.cross(along);
  const float scale = (*materials_)[material].tiles_per_metre;
  const auto uv = [&](const Vector3f& p) -> Vector2f {
    return scale * (texture_origin_ + Vector2f((p - a).dot(along), (p - a).dot(across)));
  };
  AddQuad(material, {a, b, c, d}, {uv(a), uv(b), uv(c), uv(d)});
}

void MeshBuilder::AddGroundPolygon(MaterialId material, const std::vector<Vector3f>& corners) {
  if (corners.size() < 3) return;
  const float scale = (*materials_)[material].tiles_per_metre;
  Vector3f normal = Vector3f::Zero();
  for (size_t i = 2; i < corners.size(); ++i) {
    normal += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
  }
  if (normal.norm() < kSmallestArea) return;
  normal.normalize();
  std::vector<uint32_t> index;
  for (const Vector3f& p : corners)
    index.push_back(AddVertex(p, normal, scale * p.x(), scale * p.y()));
  for (size_t i = 2; i < index.size(); ++i) AddTriangle(material, index[0], index[i - 1], index[i]);
}

void MeshBuilder::AddBox(MaterialId material, const Panel& panel, float x0, float x1, float z0,
                         float z1, float depth0, float depth1) {
  AddRectangle(material, panel, x0, x1, z0, z1, depth1);
  AddFace(material, panel.At(x0, z1, depth1), panel.At(x1, z1, depth1), panel.At(x1, z1, depth0),
          panel.At(x0, z1, depth0));
  AddFace(material, panel.At(x1, z0, depth1), panel.At(x0, z0, depth1), panel.At(x0, z0, depth0),
          panel.At(x1, z0, depth0));
  AddFace(material, panel.At(x0, z0, depth0), panel.At(x0, z0, depth1), panel.At(x0, z1, depth1),
          panel.At(x0, z1, depth0));
  AddFace(material, panel.At(x1, z0, depth1), panel.At(x1, z0, depth0), panel.At(x1, z1, depth0),
          panel.At(x1, z1, depth1));
}

void MeshBuilder::AddTube(MaterialId material, const Vector3f& a, const Vector3f& b, float radius_a,
                          float radius_b, int sides) {
  const Vector3f axis = (b - a).normalized();
  const Vector3f x = axis.unitOrthogonal();
  const Vector3f y = axis.cross(x);
  const float scale = (*materials_)[material].tiles_per_metre;
  const float length = (b - a).norm();
  const float circumference = 2 * std::numbers::pi_v<float> * std::max(radius_a, radius_b);
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  for (int i = 0; i <= sides; ++i) {
    const float fraction = static_cast<float>(i) / static_cast<float>(sides);
    const float angle = 2 * std::numbers::pi_v<float> * fraction;
    const Vector3f normal = std::cos(angle) * x + std::sin(angle) * y;
    AddVertex(a + radius_a * normal, normal, scale * circumference * fraction, 0);
    AddVertex(b + radius_b * normal, normal, scale * circumference * fraction, scale * length);
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(sides); ++i) {
    const uint32_t k = first + 2 * i;
    AddTriangle(material, k, k + 2, k + 3);
    AddTriangle(material, k, k + 3, k + 1);
  }
}

void MeshBuilder::AddEllipsoid(MaterialId material, const Vector3f& centre, const Vector3f& radii) {
  constexpr int kRings = 8;
  constexpr int kSides = 12;
  constexpr float kPi = std::numbers::pi_v<float>;
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  for (int i = 0; i <= kRings; ++i) {
    const float latitude = kPi * (static_cast<float>(i) / kRings - 0.5F);
    for (int k = 0; k <= kSides; ++k) {
      const float longitude = 2 * kPi * static_cast<float>(k) / kSides;
      const Vector3f d(std::cos(latitude) * std::cos(longitude),
                       std::cos(latitude) * std::sin(longitude), std::sin(latitude));
      AddVertex(centre + d.cwiseProduct(radii), d.cwiseQuotient(radii).normalized(),
                0.3F * longitude, 0.3F * latitude);
    }
  }
  for (uint32_t i = 0; i < kRings; ++i) {
    for (uint32_t k = 0; k < kSides; ++k) {
      const uint32_t a = first + i * (kSides + 1) + k;
      AddTriangle(material, a, a + 1, a + kSides + 2);
      AddTriangle(material, a, a + kSides + 2, a + kSides + 1);
    }
  }
}

}  // namespace orb360::town
