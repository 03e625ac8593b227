#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "apps/town/world/materials.h"

namespace orb360::town {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// The values besides the position that are interpolated over a triangle.
struct Vertex {
  float u = 0;  ///< in tiles of the texture
  float v = 0;
  Eigen::Matrix<int8_t, 3, 1> normal{0, 0, 127};  ///< unit normal times 127
  uint8_t openness = 255;  ///< fraction of the sky a cosine-weighted look sees, times 255
  std::array<uint8_t, 4> tint{255, 255, 255, 255};  ///< square root of a linear factor, times 255
};
static_assert(sizeof(Vertex) == 16, "three of these are read for each hit");

struct Triangle {
  std::array<uint32_t, 3> vertices;
  MaterialId material = 0;
  float tiles_per_metre = 1;  ///< texture coordinates per metre along the surface
};

/// Triangles with materials. Front faces are counter-clockwise.
struct Mesh {
  std::vector<Vector3f> positions;
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
  /// By vertex, the radiance that a white matte surface there has without the direct sun (the
  /// irradiance over pi), linear red, green, blue. Empty: the sky lights the mesh, as far as
  /// Vertex::openness lets it.
  std::vector<Vector3f> irradiance;
  size_t opaque_count = 0;  ///< triangles before this one have no cut-outs; set by PartitionCutouts

  /// Moves the triangles of materials with cut-outs to the end.
  void PartitionCutouts(const Palette& palette);
  /// Appends another mesh's faces; both have no irradiance.
  void Append(const Mesh& other, const Eigen::Affine3f& mesh_from_other);
};

/// Returns a linear tint as stored in Vertex.
std::array<uint8_t, 4> EncodeTint(const Rgba& tint);

/// A plane on which to draw: x to the right, z up along it, depth outward, all in metres.
struct Panel {
  Vector3f origin;
  Vector3f right;
  Vector3f up;
  Vector3f out;

  Vector3f At(float x, float z, float depth = 0) const {
    return origin + x * right + z * up + depth * out;
  }
};

/// Adds faces with flat normals to a mesh. Texture coordinates are in metres times the material's
/// tiles per metre unless stated otherwise.
class MeshBuilder {
 public:
  explicit MeshBuilder(const Materials& materials) : materials_(&materials) {}

  Mesh& mesh() { return mesh_; }
  const Materials& materials() const { return *materials_; }
  /// Sets the linear factor on the colour of the material for the faces that follow.
  void set_tint(const Rgba& tint) { tint_ = EncodeTint(tint); }
  /// Shifts the texture of the faces that follow if they are scaled in metres.
  void set_texture_origin(const Vector2f& origin) { texture_origin_ = origin; }

  /// Adds a quad. Corners are counter-clockwise seen from the front; `uv` is in tiles.
  void AddQuad(MaterialId material, const std::array<Vector3f, 4>& corners,
               const std::array<Vector2f, 4>& uv);
  /// Adds the rectangle [x0, x1] x [z0, z1] of a panel at `depth`, with a texture in metres.
  void AddRectangle(MaterialId material, const Panel& panel, float x0, float x1, float z0, float z1,
                    float depth = 0);
  /// As above, but the unit tile of the texture spans the rectangle.
  void AddImage(MaterialId material, const Panel& panel, float x0, float x1, float z0, float z1,
                float depth = 0);
  /// Adds a quad of any orientation, textured in metres along its first edge and across it.
  void AddFace(MaterialId material, const Vector3f& a, const Vector3f& b, const Vector3f& c,
               const Vector3f& d);
  /// Adds a convex polygon as a fan of triangles, textured in metres along x and y.
  void AddGroundPolygon(MaterialId material, const std::vector<Vector3f>& corners);
  /// Adds a box without back on a panel: [x0, x1] x [z0, z1] x [depth0, depth1].
  void AddBox(MaterialId material, const Panel& panel, float x0, float x1, float z0, float z1,
              float depth0, float depth1);
  /// Adds a cylinder or a truncated cone around the segment from `a` to `b`, with smooth normals
  /// and without caps.
  void AddTube(MaterialId material, const Vector3f& a, const Vector3f& b, float radius_a,
               float radius_b, int sides);

  /// Adds an ellipsoid along the axes with smooth normals.
  void AddEllipsoid(MaterialId material, const Vector3f& centre, const Vector3f& radii);

  /// Adds a vertex; `normal` must be a unit vector.
  uint32_t AddVertex(const Vector3f& position, const Vector3f& normal, float u, float v);
  void AddTriangle(MaterialId material, uint32_t a, uint32_t b, uint32_t c);

 private:
  Mesh mesh_;
  const Materials* materials_;
  std::array<uint8_t, 4> tint_{255, 255, 255, 255};
  Vector2f texture_origin_ = Vector2f::Zero();
};

}  // namespace orb360::town
