#include "apps/town/import/quake_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "apps/town/import/quake_bsp.h"
#include "apps/town/import/quake_faces.h"
#include "apps/town/import/quake_light.h"
#include "apps/town/import/quake_surface.h"
#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Longest edge over which light is interpolated, in units (0.38 m where a unit is 1/32 m).
constexpr float kLongestEdge = 12;
/// Triangles; a damaged map must not take all memory.
constexpr size_t kMaxTriangles = 20'000'000;

/// A model at its place.
struct PlacedModel {
  QuakeModel model;
  Eigen::Vector3f origin;
};

/// Returns what does not move, and the models of entities that people see: triggers are volumes
/// without a surface.
std::vector<PlacedModel> PlaceModels(const QuakeMap& map) {
  std::vector<PlacedModel> placed = {{map.models[0], Eigen::Vector3f::Zero()}};
  for (const QuakeEntity& entity : map.entities) {
    const std::string model = ValueOf(entity, "model");
    const std::string kind = ValueOf(entity, "classname");
    if (!model.starts_with('*') || kind.starts_with("trigger_") || kind == "func_door") continue;
    const auto number = ParseNumber<size_t>(model.substr(1));
    if (!number || *number == 0 || *number >= map.models.size()) continue;
    const auto origin = VectorOf(entity, "origin").value_or(Eigen::Vector3f::Zero());
    placed.push_back({map.models[*number], origin});
  }
  return placed;
}

/// Returns the light at a vertex of a face.
Eigen::Vector3f LightAt(const QuakeMap& map, const QuakeFace& face, const QuakeVertex& vertex) {
  if (face.light_page < 0) return QuakeIrradiance(vertex.colour);
  const auto page =
      std::span(map.light_pages)
          .subspan(static_cast<size_t>(face.light_page) * kLightPageBytes, kLightPageBytes);
  return QuakeIrradiance(SampleLightPage(page, vertex.light_uv));
}

/// Returns unit normals of the vertices: their own, or, where a map has none, that of the triangles
/// around them.
std::vector<Eigen::Vector3f> UnitNormals(const FaceMesh& face) {
  std::vector<Eigen::Vector3f> around(face.vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : face.triangles) {
    const Eigen::Vector3f& p = face.vertices[a].position;
    const Eigen::Vector3f normal =
        (face.vertices[b].position - p).cross(face.vertices[c].position - p);
    for (const uint32_t i : {a, b, c}) around[i] += normal;
  }
  std::vector<Eigen::Vector3f> normals;
  for (size_t i = 0; i < around.size(); ++i) {
    Eigen::Vector3f normal = face.vertices[i].normal.stableNormalized();
    const auto is_unit = [&] { return normal.squaredNorm() > 0.5F; };  // false for NaN
    if (!is_unit()) normal = around[i].stableNormalized();
    if (!is_unit()) normal = Eigen::Vector3f::UnitZ();  // a vertex of no triangle
    normals.push_back(normal);
  }
  return normals;
}

/// Adds a face to the mesh of its surface; `triangles` counts those of the whole scene.
void AddFace(const QuakeMap& map, const QuakeFace& face, const QuakeSurface& surface,
             const Eigen::Vector3f& origin, size_t* triangles, SourceMesh* mesh) {
  FaceMesh divided = TrianglesOf(map, face);
  if (surface.is_lit && face.light_page >= 0)
    DivideForLight(kLongestEdge, kMaxTriangles - *triangles, &divided);
  *triangles += std::max(divided.triangles.size(), divided.vertices.size());
  if (*triangles > kMaxTriangles)
    throw UserError("has more than " + std::to_string(kMaxTriangles) + " triangles");
  if (divided.triangles.empty()) return;
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  const auto uv_of = [&](const QuakeVertex& vertex) -> Eigen::Vector2f {
    return vertex.uv.cwiseProduct(surface.texture_scale);
  };
  // Texture coordinates keep their precision where they are small.
  const Eigen::Vector2f whole_tiles = uv_of(divided.vertices[0]).array().floor();
  const std::vector<Eigen::Vector3f> normals = UnitNormals(divided);
  mesh->normals.insert(mesh->normals.end(), normals.begin(), normals.end());
  for (const QuakeVertex& vertex : divided.vertices) {
    const Eigen::Vector2f uv = uv_of(vertex) - whole_tiles;
    mesh->positions.emplace_back(vertex.position + origin);
    mesh->texture_coordinates.emplace_back(uv.x(), -uv.y());
    mesh->irradiance.push_back(surface.is_lit ? LightAt(map, face, vertex)
                                              : Eigen::Vector3f::Ones());
  }
  for (const auto& [a, b, c] : divided.triangles)
    mesh->triangles.push_back({first + a, first + b, first + c});
}

/// Returns where players begin: the floor below their origin, about which their box reaches from
/// -24 to 32.
std::vector<Eigen::Vector3f> FindStarts(const QuakeMap& map) {
  constexpr float kOriginAboveFloor = 24;
  std::vector<Eigen::Vector3f> starts;
  for (const QuakeEntity& entity : map.entities) {
    const std::string kind = ValueOf(entity, "classname");
    if (kind != "info_player_deathmatch" && kind != "info_player_start" &&
        !kind.starts_with("team_CTF_"))
      continue;
    if (const auto origin = VectorOf(entity, "origin"))
      starts.emplace_back(*origin - kOriginAboveFloor * Eigen::Vector3f::UnitZ());
  }
  return starts;
}

}  // namespace

SourceScene ReadQuakeScene(const std::filesystem::path& path) {
  const QuakeMap map = ReadQuakeMap(path);
  const std::filesystem::path game = std::filesystem::absolute(path).parent_path().parent_path();
  const QuakeShaders shaders = ReadQuakeShaders(game / "scripts");
  const QuakeImages images = FindQuakeImages(game);
  SourceScene scene;
  scene.starts = FindStarts(map);
  std::vector<QuakeSurface> surfaces;
  std::map<size_t, size_t> mesh_of;  // by surface, where it has faces
  for (const QuakeShaderName& name : map.shaders)
    surfaces.push_back(ChooseQuakeSurface(name, shaders, images));
  size_t triangles = 0;
  try {
    for (const auto& [model, origin] : PlaceModels(map)) {
      for (size_t i = model.first_face; i < model.first_face + model.face_count; ++i) {
        const QuakeFace& face = map.faces[i];
        const QuakeSurface& surface = surfaces[face.shader];
        if (!surface.is_shown || face.kind == QuakeFaceKind::kBillboard) continue;
        const auto [entry, is_new] = mesh_of.try_emplace(face.shader, scene.meshes.size());
        if (is_new) {
          scene.materials.push_back(surface.material);
          SourceMesh& mesh = scene.meshes.emplace_back();
          mesh.name = map.shaders[face.shader].name;
          mesh.material = scene.materials.size() - 1;
        }
        AddFace(map, face, surface, origin, &triangles, &scene.meshes[entry->second]);
      }
    }
  } catch (const UserError& error) {
    throw UserError(path.string() + ": " + error.what() + ": the map is damaged or too large");
  }
  return scene;
}

}  // namespace orb360::town
