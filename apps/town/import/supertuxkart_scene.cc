#include "apps/town/import/supertuxkart_scene.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "apps/town/import/spm_mesh.h"
#include "apps/town/import/supertuxkart_materials.h"
#include "apps/town/import/xml_file.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Library nodes may hold others, so a node that holds itself would never end.
constexpr int kDeepest = 8;
constexpr size_t kMaxVertices = 50'000'000;  // and triangles, of all that is placed
constexpr size_t kMaxNodes = 100'000;  // of the library; tracks of the game place some hundreds

Eigen::Affine3f ParentFromElement(const pugi::xml_node& element,
                                  const std::filesystem::path& file) {
  const Eigen::Vector3f place = ReadVector(element, "xyz", Eigen::Vector3f::Zero(), file);
  const Eigen::Vector3f degrees = ReadVector(element, "hpr", Eigen::Vector3f::Zero(), file);
  const Eigen::Vector3f scale = ReadVector(element, "scale", Eigen::Vector3f::Ones(), file);
  const Eigen::Vector3f angles = degrees * (std::numbers::pi_v<float> / 180);
  using Turn = Eigen::AngleAxisf;
  return Eigen::Translation3f(place) * Turn(angles.z(), Eigen::Vector3f::UnitZ()) *
         Turn(angles.y(), Eigen::Vector3f::UnitY()) * Turn(angles.x(), Eigen::Vector3f::UnitX()) *
         Eigen::Scaling(scale);
}

/// Returns true if an ordinary race shows the element: `if` names a special mode, a locked
/// challenge, or with Not or No the absence of one.
bool IsShown(const pugi::xml_node& element) {
  const std::string_view condition = element.attribute("if").value();
  return condition.empty() || condition.find("No") != condition.npos ||
         condition == "showDoorClosed";
}

/// Returns true for a model that is seen and stands still.
bool IsStillSurface(const pugi::xml_node& element) {
  const std::string_view interaction = element.attribute("interaction").value();
  if (interaction == "physics-only" || interaction == "physicsonly") return false;
  const std::string_view type = element.attribute("type").value();
  return (type.empty() || type == "animation" || type == "static") && !element.child("curve") &&
         IsShown(element);
}

/// Returns a folder and those in it, in alphabetical order; only the folder if it does not exist.
std::vector<std::filesystem::path> WithSubfolders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> all = {folder};
  if (!std::filesystem::is_directory(folder)) return all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_directory()) all.push_back(entry.path());
  }
  std::sort(all.begin() + 1, all.end());
  return all;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file)
      : folder_(std::filesystem::absolute(file).parent_path()),
        data_(folder_.parent_path().parent_path()),
        shared_textures_(WithSubfolders(data_ / "textures")) {
    const Place track = ReadPlace(folder_, file);
    const pugi::xml_node model = Root(track).child("track");
    if (!model.attribute("model"))
      throw UserError(file.string() + ": has no <track> with a model, as a scene of SuperTuxKart");
    const std::filesystem::path mesh = folder_ / model.attribute("model").value();
    std::error_code error;
    if (!std::filesystem::is_regular_file(mesh, error)) {
      throw UserError(mesh.string() + ": no such file: the model of the track is needed beside " +
                      file.filename().string());
    }
    const Eigen::Affine3f as_it_is = Eigen::Affine3f::Identity();
    const Eigen::Vector3f place(model.attribute("x").as_float(), model.attribute("y").as_float(),
                                model.attribute("z").as_float());
    AddModel(track, model.attribute("model").value(), as_it_is * Eigen::Translation3f(place));
    for (const pugi::xml_node& element : model.children("static-object"))
      AddObject(track, element, as_it_is);
    AddElements(track, as_it_is, 0);
  }

  SourceScene Take() { return std::move(scene_); }

 private:
  /// A folder with a scene: a track or a node of the library.
  struct Place {
    std::filesystem::path folder;
    std::filesystem::path file;
    std::shared_ptr<const pugi::xml_document> document;
    std::shared_ptr<const KartMaterials> materials;
    std::map<std::string, std::string> finest;  // models of groups of levels of detail
  };

  static pugi::xml_node Root(const Place& place) { return place.document->child("scene"); }

  Place ReadPlace(const std::filesystem::path& folder, const std::filesystem::path& file) {
    Place place{folder, file, {}, {}, {}};
    place.document = std::make_shared<const pugi::xml_document>(ReadXml(file, "scene"));
    std::vector<std::filesystem::path> folders = {folder};
    if (folder != folder_) folders.push_back(folder_);
    folders.insert(folders.end(), shared_textures_.begin(), shared_textures_.end());
    place.materials = std::make_shared<const KartMaterials>(std::move(folders));
    for (const pugi::xml_node& group : Root(place).child("lod").children("group")) {
      float nearest = std::numeric_limits<float>::infinity();
      for (const pugi::xml_node& level : group.children("static-object")) {
        const float distance = level.attribute("lod_distance").as_float();
        if (distance >= nearest) continue;
        nearest = distance;
        place.finest[group.attribute("name").value()] = level.attribute("model").value();
      }
    }
    return place;
  }

  void AddElements(const Place& place, const Eigen::Affine3f& world_from_place, int depth) {
    for (const char* kind : {"object", "static-object", "water"}) {
      for (const pugi::xml_node& element : Root(place).children(kind))
        AddObject(place, element, world_from_place);
    }
    for (const pugi::xml_node& element : Root(place).children("library")) {
      if (element.child("curve") || !IsShown(element)) continue;
      const std::string name = element.attribute("name").value();
      if (depth == kDeepest)
        throw UserError(place.file.string() + ": nodes of the library are nested too deeply");
      if (++placed_ > kMaxNodes)
        throw UserError(place.file.string() + ": nodes of the library multiply to more than " +
                        std::to_string(kMaxNodes));
      const Place* node = FindNode(name);
      if (node == nullptr) continue;
      AddElements(*node, world_from_place * ParentFromElement(element, place.file), depth + 1);
    }
  }

  /// Returns a node of the library; null if it does not exist.
  const Place* FindNode(const std::string& name) {
    if (const auto known = nodes_.find(name); known != nodes_.end()) return &known->second;
    const std::filesystem::path folder = data_ / "library" / name;
    if (!std::filesystem::exists(folder / "node.xml")) {
      AddMissing((folder / "node.xml").string() + ": no such file");
      return nullptr;
    }
    return &nodes_.emplace(name, ReadPlace(folder, folder / "node.xml")).first->second;
  }

  void AddMissing(const std::string& problem) {
    std::vector<std::string>& all = scene_.missing;
    if (std::find(all.begin(), all.end(), problem) == all.end()) all.push_back(problem);
  }

  void AddObject(const Place& place, const pugi::xml_node& element,
                 const Eigen::Affine3f& world_from_place) {
    if (!IsStillSurface(element)) return;
    std::string model = element.attribute("model").value();
    if (element.attribute("lod_instance").as_bool()) {
      const auto group = place.finest.find(element.attribute("lod_group").value());
      if (group != place.finest.end()) model = group->second;
    }
    const bool is_liquid = std::string_view(element.name()) == "water";
    if (!model.empty())
      AddModel(place, model, world_from_place * ParentFromElement(element, place.file), is_liquid);
  }

  void AddModel(const Place& place, const std::filesystem::path& name,
                const Eigen::Affine3f& world_from_model, bool is_liquid = false) {
    std::error_code error;
    std::filesystem::path file = place.folder / name;
    for (const std::filesystem::path& folder : {folder_, data_ / "models"}) {
      if (!std::filesystem::is_regular_file(file, error)) file = folder / name;
    }
    if (!std::filesystem::is_regular_file(file, error)) {
      AddMissing((place.folder / name).string() + ": no such file");
      return;
    }
    auto [model, is_new] = models_.try_emplace(file);
    if (is_new) model->second = ReadSpm(file);
    for (const SpmPart& part : model->second) {
      const KartSurface surface = place.materials->SurfaceOf(part.texture);
      if (surface == KartSurface::kNone) continue;
      vertices_ += part.mesh.positions.size() + part.mesh.triangles.size();
      if (vertices_ > kMaxVertices)
        throw UserError(place.file.string() + ": places models of more than " +
                        std::to_string(kMaxVertices) + " vertices and triangles");
      scene_.meshes.push_back(Placed(part.mesh, world_from_model));
      scene_.meshes.back().name = file.filename().string();
      scene_.meshes.back().material =
          FindMaterial(*place.materials, part.texture, surface == KartSurface::kOpaque, is_liquid);
    }
  }

  /// Returns the mesh in the world, in right-handed axes.
  static SourceMesh Placed(SourceMesh mesh, const Eigen::Affine3f& world_from_model) {
    const Eigen::Affine3f right_from_model =
        Eigen::Affine3f(Eigen::Scaling(1.0F, 1.0F, -1.0F)) * world_from_model;
    const Eigen::Matrix3f linear = right_from_model.linear();
    const Eigen::Matrix3f turn = linear.inverse().transpose();
    for (Eigen::Vector3f& position : mesh.positions) position = right_from_model * position;
    for (Eigen::Vector3f& normal : mesh.normals) normal = (turn * normal).stableNormalized();
    if (!turn.allFinite()) mesh.normals.clear();
    if (linear.determinant() < 0) {  // mirrored triangles are the other way round
      for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
    }
    return mesh;
  }

  size_t FindMaterial(const KartMaterials& materials, const std::string& texture, bool is_opaque,
                      bool is_liquid) {
    const std::string file = materials.FileOf(texture);
    const auto [found, is_new] =
        materials_.try_emplace({file, is_opaque, is_liquid}, scene_.materials.size());
    if (is_new) {
      SourceMaterial& material = scene_.materials.emplace_back();
      material.texture = file;
      material.is_opaque = is_opaque;
      material.is_liquid = is_liquid;
      if (!is_opaque) material.image = materials.MaskedImage(texture);
    }
    return found->second;
  }

  std::filesystem::path folder_;  // of the track
  std::filesystem::path data_;    // of the game, with library, textures and tracks
  std::vector<std::filesystem::path> shared_textures_;
  std::map<std::string, Place> nodes_;
  std::map<std::filesystem::path, std::vector<SpmPart>> models_;
  std::map<std::tuple<std::string, bool, bool>, size_t> materials_;  // file, is_opaque, is_liquid
  size_t placed_ = 0;                                                // nodes of the library
  size_t vertices_ = 0;  // and triangles, of all models that are placed
  SourceScene scene_;
};

}  // namespace

SourceScene ReadSuperTuxKartScene(const std::filesystem::path& scene_file) {
  return Reader(scene_file).Take();
}

}  // namespace orb360::town
