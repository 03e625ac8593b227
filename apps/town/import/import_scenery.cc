#include "apps/town/import/import_scenery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "apps/town/import/ac3d.h"
#include "apps/town/import/assimp_scene.h"
#include "apps/town/import/quake_scene.h"
#include "apps/town/import/supertuxkart_scene.h"
#include "apps/town/import/texture_file.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Finds the file of a texture: by the path that the mesh gives, or, if that belongs to its
/// author's computer, by the name only. Throws UserError if it is in none of the folders.
std::filesystem::path FindTexture(std::string name,
                                  const std::vector<std::filesystem::path>& folders) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const std::filesystem::path path(name);
  for (const std::filesystem::path& folder : folders) {
    for (const std::filesystem::path& candidate : {folder / path, folder / path.filename()}) {
      if (std::filesystem::is_regular_file(candidate)) return candidate;
    }
  }
  throw UserError((folders.front() / path).string() + ": no such file");
}

/// Adds the materials to the palette in their order.
void AddMaterials(const SourceScene& source, const std::vector<std::filesystem::path>& folders,
                  std::vector<std::string>* missing, Palette* palette) {
  struct Loaded {
    uint16_t texture;
    bool has_holes;
  };
  if (source.materials.size() > std::numeric_limits<MaterialId>::max())
    throw UserError("the mesh has more than 65535 materials: join some");
  std::map<std::pair<std::string, bool>, Loaded> loaded;  // by name and is_opaque
  const auto plain = [](float level) { return Texture(1, 1, {Rgba{level, level, level, 1}}); };
  palette->textures.push_back(plain(1));  // for surfaces without a texture
  for (const bool is_opaque : {false, true}) loaded[{"", is_opaque}] = {0, false};
  for (const SourceMaterial& material : source.materials) {
    auto [entry, is_new] = loaded.try_emplace({material.texture, material.is_opaque});
    if (is_new) {
      bool has_holes = false;
      const Alpha alpha = material.is_opaque ? Alpha::kIgnored : Alpha::kCoverage;
      try {
        ImageTexture image = material.image.empty()
                                 ? ReadTexture(FindTexture(material.texture, folders), alpha)
                                 : MakeTexture(material.image, material.texture, alpha);
        has_holes = image.has_holes;
        palette->textures.push_back(std::move(image.texture));
      } catch (const UserError& error) {
        missing->push_back(error.what());
        palette->textures.push_back(plain(0.4F));
      }
      entry->second = {static_cast<uint16_t>(palette->textures.size() - 1), has_holes};
    }
    Material& added = palette->all.emplace_back();
    added.texture = entry->second.texture;
    added.cutout = entry->second.has_holes;
    // Leaves and nets on flat faces transmit light from both sides.
    if (added.cutout) added.finish = Finish::kFoliage;
  }
}

/// Returns area-weighted means of the normals of the faces that share a vertex.
std::vector<Vector3f> SmoothNormals(const std::vector<Vector3f>& positions,
                                    const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<Vector3f> normals(positions.size(), Vector3f::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vector3f normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const uint32_t corner : {a, b, c}) normals[corner] += normal;
  }
  for (Vector3f& normal : normals) {
    normal.stableNormalize();
    if (!normal.allFinite() || normal.squaredNorm() < 0.5F) normal = Vector3f::UnitZ();
  }
  return normals;
}

/// Returns the tiles of texture per metre of a triangle.
float TilesPerMetre(const std::array<Vector3f, 3>& p, const std::array<Vector2f, 3>& uv) {
  const float area = (p[1] - p[0]).cross(p[2] - p[0]).norm();
  const Vector2f u = uv[1] - uv[0];
  const Vector2f v = uv[2] - uv[0];
  const float tiles = std::abs(u.x() * v.y() - u.y() * v.x());
  return std::sqrt(tiles / std::max(area, 1e-9F));
}

/// Returns a vector of the file with z upward.
Vector3f Turned(const Vector3f& v, UpAxis up) {
  return up == UpAxis::kY ? Vector3f(v.x(), -v.z(), v.y()) : v;
}

/// Appends the light of a mesh's vertices. What has none among meshes with baked light looks as its
/// texture does.
void AddIrradiance(const SourceMesh& source, Mesh* mesh) {
  const bool is_baked = source.irradiance.size() == source.positions.size();
  for (size_t i = 0; i < source.positions.size(); ++i)
    mesh->irradiance.emplace_back(is_baked ? source.irradiance[i] : Vector3f::Ones());
}

void AddMesh(const SourceMesh& source, const Eigen::Vector3f& colour, const ImportOptions& options,
             Mesh* mesh) {
  std::vector<Vector3f> positions;
  constexpr float kFarthest = 1e6;  // metres; beyond it single precision is coarser than 6 cm
  for (const Vector3f& p : source.positions) {
    positions.push_back(ToWorld(p, options));
    if (!(positions.back().cwiseAbs().maxCoeff() <= kFarthest))
      throw UserError("the mesh has vertices more than 1000 km from its origin (see --scale)");
  }
  std::vector<Vector3f> normals;
  if (source.normals.size() == positions.size()) {
    for (const Vector3f& normal : source.normals) normals.push_back(Turned(normal, options.up));
  } else {
    normals = SmoothNormals(positions, source.triangles);
  }
  const bool has_uv = source.texture_coordinates.size() == positions.size();
  const auto uv_of = [&](uint32_t i) -> Vector2f {
    return has_uv ? source.texture_coordinates[i] : Vector2f::Zero();
  };
  // Texture stores a texel's position in 32 bits, so tiles are counted from those of the first
  // vertex.
  Vector2f whole_tiles = Vector2f::Zero();
  if (!positions.empty()) whole_tiles = uv_of(0).array().floor();
  const auto first = static_cast<uint32_t>(mesh->vertices.size());
  const bool has_colours = source.colours.size() == positions.size();
  for (uint32_t i = 0; i < positions.size(); ++i) {
    Vertex vertex;
    vertex.u = uv_of(i).x() - whole_tiles.x();
    vertex.v = uv_of(i).y() - whole_tiles.y();
    vertex.normal = (normals[i] * 127).array().round().cast<int8_t>();
    const Vector3f factor = has_colours ? colour.cwiseProduct(source.colours[i]) : colour;
    vertex.tint = EncodeTint({factor.x(), factor.y(), factor.z(), 1});
    mesh->positions.push_back(positions[i]);
    mesh->vertices.push_back(vertex);
  }
  for (const auto& [a, b, c] : source.triangles) {
    ORB360_CHECK(std::max({a, b, c}) < positions.size(), source.name);
    mesh->triangles.push_back({{first + a, first + b, first + c},
                               static_cast<MaterialId>(source.material),
                               TilesPerMetre({positions[a], positions[b], positions[c]},
                                             {uv_of(a), uv_of(b), uv_of(c)})});
  }
}

SourceScene ReadAnyFormat(const std::filesystem::path& path) {
  if (path.filename() == "scene.xml") return ReadSuperTuxKartScene(path);
  const std::string extension = LowerExtension(path);
  if (extension == ".bsp") return ReadQuakeScene(path);
  return extension == ".ac" || extension == ".acc" ? ReadAc3d(path) : ReadWithAssimp(path);
}

}  // namespace

Vector3f ToWorld(const Vector3f& position, const ImportOptions& options) {
  return static_cast<float>(options.scale) * Turned(position, options.up);
}

SourceScene ReadMeshFile(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw UserError(path.string() + ": no such file");
  if (std::filesystem::is_directory(path))
    throw UserError(path.string() + ": is a folder: name the file of meshes in it");
  SourceScene scene = ReadAnyFormat(path);
  const bool has_triangles = std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                         [](const SourceMesh& m) { return !m.triangles.empty(); });
  if (!has_triangles) throw UserError(path.string() + ": holds no triangle");
  return scene;
}

Scenery MakeScenery(const SourceScene& source, const std::filesystem::path& folder,
                    const ImportOptions& options, std::vector<std::string>* missing) {
  std::vector<std::filesystem::path> folders = {folder};
  folders.insert(folders.end(), options.texture_folders.begin(), options.texture_folders.end());
  // This folder of a TORCS circuit lies beside tracks/CATEGORY/NAME.
  folders.push_back(std::filesystem::absolute(folder) / "../../../data/textures");
  Scenery scenery;
  AddMaterials(source, folders, missing, &scenery.palette);
  const bool has_light = std::ranges::any_of(
      source.meshes, [](const SourceMesh& mesh) { return !mesh.irradiance.empty(); });
  for (const SourceMesh& mesh : source.meshes) {
    AddMesh(mesh, source.materials[mesh.material].colour, options, &scenery.fixed);
    if (has_light) AddIrradiance(mesh, &scenery.fixed);
  }
  scenery.fixed.PartitionCutouts(scenery.palette);
  return scenery;
}

}  // namespace orb360::town
