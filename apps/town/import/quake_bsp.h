#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "apps/town/import/quake_entities.h"

namespace orb360::town {

/// The surface of a face, described by a script of that name or by an image.
struct QuakeShaderName {
  std::string name;       ///< such as "textures/base_wall/concrete"
  uint32_t flags = 0;     ///< what the compiler of the map noted about the surface
  uint32_t contents = 0;  ///< and about the volume behind it
};

/// Bits of QuakeShaderName::flags and QuakeShaderName::contents.
struct QuakeBits {
  static constexpr uint32_t kSky = 0x4, kNoDraw = 0x80, kHint = 0x100, kSkip = 0x200;
  static constexpr uint32_t kLava = 0x8, kSlime = 0x10, kWater = 0x20, kFog = 0x40;
};

struct QuakeVertex {
  Eigen::Vector3f position;
  Eigen::Vector2f uv;        ///< in tiles; v grows downward in the image
  Eigen::Vector2f light_uv;  ///< in pages of light, [0, 1], v downward
  Eigen::Vector3f normal;
  Eigen::Vector3f colour;  ///< baked light, 0 to 255
};

enum class QuakeFaceKind { kPolygon = 1, kPatch = 2, kMesh = 3, kBillboard = 4 };

/// A face: triangles (polygon and mesh), or a grid of control points (patch).
struct QuakeFace {
  QuakeFaceKind kind = QuakeFaceKind::kPolygon;
  size_t shader = 0;
  size_t first_vertex = 0;
  size_t vertex_count = 0;
  size_t first_index = 0;  ///< into QuakeMap::indices, which count from first_vertex
  size_t index_count = 0;
  int light_page = -1;  ///< negative: the colours of the vertices are the light
  size_t patch_width = 0, patch_height = 0;  ///< control points, odd, at least 3
};

/// A range of faces: 0 is what does not move, the others belong to entities.
struct QuakeModel {
  size_t first_face = 0;
  size_t face_count = 0;
};

/// Baked light: 128 x 128 pixels of red, green and blue.
inline constexpr size_t kLightPageSide = 128;
inline constexpr size_t kLightPageBytes = kLightPageSide * kLightPageSide * 3;

/// The contents of a map of Quake 3, z up, in the map's units. All indices are valid.
struct QuakeMap {
  std::vector<QuakeEntity> entities;
  std::vector<QuakeShaderName> shaders;
  std::vector<QuakeVertex> vertices;
  std::vector<uint32_t> indices;
  std::vector<QuakeFace> faces;
  std::vector<QuakeModel> models;
  std::vector<uint8_t> light_pages;
};

/// Reads a compiled map (.bsp, "IBSP" version 46). Throws UserError for a file that is damaged or
/// of another kind. Format: Kekoa Proudfoot, "Unofficial Quake 3 Map Specs", 2000.
QuakeMap ReadQuakeMap(const std::filesystem::path& path);

}  // namespace orb360::town
