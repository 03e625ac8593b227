#include "apps/town/import/ac3d.h"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "apps/town/import/triangulate.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Kinds of surface, in the lower four bits of its flags.
enum SurfaceKind : unsigned { kPolygon = 0, kStrip = 4 };

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path), file_(path) {
    if (!file_) throw UserError(path.string() + ": cannot be opened");
  }

  SourceScene Read() {
    std::istringstream line = NextLine();
    std::string word;
    line >> word;
    if (!word.starts_with("AC3D")) Refuse("is not an AC3D file: it does not begin with AC3D");
    while (HasLine()) {
      line = NextLine();
      if (!(line >> word)) continue;
      if (word == "MATERIAL") {
        ReadMaterial(line);
      } else if (word == "OBJECT") {
        ReadObject(Eigen::Affine3f::Identity());
      } else {
        Refuse("expected MATERIAL or OBJECT, found '" + word + "'");
      }
    }
    return std::move(scene_);
  }

 private:
  struct Object {
    Eigen::Affine3f parent_from_object = Eigen::Affine3f::Identity();
    std::string name;
    std::string texture;
    Eigen::Vector2f texture_repeats = Eigen::Vector2f::Ones();
    Eigen::Vector2f texture_offset = Eigen::Vector2f::Zero();
    std::vector<Eigen::Vector3f> positions;
    std::vector<Eigen::Vector3f> normals;
  };
  /// A corner of a surface.
  struct Corner {
    uint32_t vertex;
    Eigen::Vector2f uv;
  };

  [[noreturn]] void Refuse(const std::string& reason) const {
    throw UserError(path_.string() + ": line " + std::to_string(line_number_) + ": " + reason);
  }
  bool HasLine() { return file_.peek() != std::ifstream::traits_type::eof(); }
  std::istringstream NextLine() {
    std::string text;
    if (!std::getline(file_, text)) Refuse("the file ends too early");
    ++line_number_;
    return std::istringstream(text);
  }
  template <typename T>
  T Number(std::istringstream& line, const char* what) const {
    T value;
    if (!(line >> value)) Refuse(std::string("expected ") + what);
    return value;
  }
  /// Reads the number of elements that follow.
  int Count(std::istringstream& line, const char* what) const {
    const int count = Number<int>(line, what);
    if (count < 0) Refuse(std::string("expected ") + what + ", found " + std::to_string(count));
    return count;
  }
  /// Reads a word, or several words between quotation marks.
  static std::string Text(std::istringstream& line) {
    std::string text;
    line >> std::ws;
    if (line.peek() != '"') {
      line >> text;
      return text;
    }
    line.get();
    std::getline(line, text, '"');
    return text;
  }

  void ReadMaterial(std::istringstream& line) {
    Text(line);  // its name
    Eigen::Vector3f diffuse = Eigen::Vector3f::Zero();
    Eigen::Vector3f emitted = Eigen::Vector3f::Zero();
    std::string word;
    while (line >> word) {
      if (word != "rgb" && word != "emis") continue;
      Eigen::Vector3f& colour = word == "rgb" ? diffuse : emitted;
      for (int i = 0; i < 3; ++i) colour[i] = Number<float>(line, "three numbers of a colour");
    }
    // A surface that only emits light is treated as reflecting instead.
    const Eigen::Vector3f colour = diffuse.isZero() ? emitted : diffuse;
    colours_.push_back(colour.cwiseMin(1.0F).cwiseMax(0.0F));
  }

  void ReadObject(const Eigen::Affine3f& world_from_parent, int depth = 0) {
    constexpr int kDeepest = 200;  // groups in groups; a damaged file must not take all the stack
    if (depth > kDeepest) Refuse("objects are nested too deeply");
    Object object;
    while (true) {
      std::istringstream line = NextLine();
      std::string word;
      if (!(line >> word)) continue;
      if (word == "kids") {
        const Eigen::Affine3f world_from_object = world_from_parent * object.parent_from_object;
        const int count = Count(line, "a number of objects");
        // Files of TORCS end before all the objects that they announce.
        for (int i = 0; i < count && HasLine(); ++i) ReadChild(world_from_object, depth + 1);
        return;
      }
      ReadProperty(word, line, world_from_parent, &object);
    }
  }

  void ReadChild(const Eigen::Affine3f& world_from_parent, int depth) {
    std::istringstream line = NextLine();
    std::string word;
    if (!(line >> word) || word != "OBJECT") Refuse("expected an OBJECT");
    ReadObject(world_from_parent, depth);
  }

  void ReadProperty(const std::string& word, std::istringstream& line,
                    const Eigen::Affine3f& world_from_parent, Object* object) {
    if (word == "name") {
      object->name = Text(line);
    } else if (word == "data") {
      // This many characters of comment follow, and an end of line.
      file_.ignore(Count(line, "a length") + 1);
      ++line_number_;
    } else if (word == "texture") {
      // .acc files have several textures with their purpose; the base is the first one.
      const std::string file = Text(line);
      if (object->texture.empty() && file != "empty_texture_no_mapping") object->texture = file;
    } else if (word == "texrep") {
      for (int i = 0; i < 2; ++i) object->texture_repeats[i] = Number<float>(line, "two numbers");
    } else if (word == "texoff") {
      for (int i = 0; i < 2; ++i) object->texture_offset[i] = Number<float>(line, "two numbers");
    } else if (word == "loc") {
      for (int i = 0; i < 3; ++i)
        object->parent_from_object.translation()[i] = Number<float>(line, "three numbers");
    } else if (word == "rot") {
      // The matrix is stored row by row for row vectors, so it is read column by column.
      for (int i = 0; i < 9; ++i)
        object->parent_from_object.linear()(i % 3, i / 3) = Number<float>(line, "nine numbers");
    } else if (word == "numvert") {
      ReadVertices(Count(line, "a number of vertices"), object);
    } else if (word == "numsurf") {
      const int count = Count(line, "a number of surfaces");
      for (int i = 0; i < count; ++i)
        ReadSurface(*object, world_from_parent * object->parent_from_object);
    }
    // Other keys (crease, url, hidden, ...) do not affect the appearance here.
  }

  void ReadVertices(int count, Object* object) {
    for (int i = 0; i < count; ++i) {
      std::istringstream line = NextLine();
      Eigen::Vector3f position;
      for (int axis = 0; axis < 3; ++axis) position[axis] = Number<float>(line, "a position");
      object->positions.push_back(position);
      Eigen::Vector3f normal;
      if (line >> normal.x() >> normal.y() >> normal.z()) object->normals.push_back(normal);
    }
  }

  void ReadSurface(const Object& object, const Eigen::Affine3f& world_from_object) {
    unsigned flags = kPolygon;
    size_t material = 0;
    while (true) {
      std::istringstream line = NextLine();
      std::string word;
      line >> word;
      if (word == "SURF") {
        line >> std::setbase(0) >> flags;  // hexadecimal after 0x
        if (!line) Refuse("expected the flags of a surface");
      } else if (word == "mat") {
        material = Number<size_t>(line, "the number of a material");
        if (material >= colours_.size()) Refuse("there is no such material");
      } else if (word == "refs") {
        const int count = Count(line, "a number of corners");
        std::vector<Corner> corners;
        for (int k = 0; k < count; ++k) {
          std::istringstream reference = NextLine();
          Corner& corner = corners.emplace_back();
          corner.vertex = Number<uint32_t>(reference, "the number of a vertex");
          if (corner.vertex >= object.positions.size()) Refuse("there is no such vertex");
          for (int i = 0; i < 2; ++i) {
            corner.uv[i] =
                Number<float>(reference, "texture coordinates") * object.texture_repeats[i] +
                object.texture_offset[i];
          }
        }
        AddSurface(object, flags & 15U, material, corners, world_from_object);
        return;
      } else {
        Refuse("expected SURF, mat or refs, found '" + word + "'");
      }
    }
  }

  void AddSurface(const Object& object, unsigned kind, size_t material,
                  const std::vector<Corner>& corners, const Eigen::Affine3f& world_from_object) {
    if ((kind != kPolygon && kind != kStrip) || corners.size() < 3) return;
    SourceMesh mesh;
    mesh.name = object.name;
    mesh.material = FindMaterial(material, object.texture);
    const bool has_normals = object.normals.size() == object.positions.size();
    // Equal corners become one vertex. They keep the order of the object's vertices, on which the
    // search for roads depends (see torcs_track.h).
    std::map<std::tuple<uint32_t, float, float>, uint32_t> indices;
    const auto key = [](const Corner& corner) {
      return std::tuple(corner.vertex, corner.uv.x(), corner.uv.y());
    };
    for (const Corner& corner : corners) indices[key(corner)] = 0;
    for (auto& [corner, index] : indices) {
      const auto [vertex, u, v] = corner;
      index = static_cast<uint32_t>(mesh.positions.size());
      mesh.positions.push_back(world_from_object * object.positions[vertex]);
      mesh.texture_coordinates.emplace_back(u, v);
      if (!has_normals) continue;
      const Eigen::Vector3f normal = world_from_object.linear() * object.normals[vertex];
      mesh.normals.push_back(normal.stableNormalized());
    }
    const auto at = [&](size_t i) { return indices.at(key(corners[i])); };
    if (kind == kPolygon) {
      std::vector<Eigen::Vector3f> outline;
      for (size_t i = 0; i < corners.size(); ++i) outline.push_back(mesh.positions[at(i)]);
      for (const auto& [i, j, k] : Triangulate(outline))
        mesh.triangles.push_back({at(i), at(j), at(k)});
    } else {
      for (size_t i = 2; i < corners.size(); ++i) {  // every other one turns the other way round
        mesh.triangles.push_back(i % 2 == 0 ? std::array{at(i - 2), at(i - 1), at(i)}
                                            : std::array{at(i - 1), at(i - 2), at(i)});
      }
    }
    scene_.meshes.push_back(std::move(mesh));
  }

  size_t FindMaterial(size_t colour, const std::string& texture) {
    const auto found = std::find_if(
        scene_.materials.begin(), scene_.materials.end(), [&](const SourceMaterial& material) {
          return material.texture == texture && material.colour == colours_[colour];
        });
    if (found != scene_.materials.end())
      return static_cast<size_t>(found - scene_.materials.begin());
    scene_.materials.push_back({colours_[colour], texture});
    return scene_.materials.size() - 1;
  }

  std::filesystem::path path_;
  std::ifstream file_;
  int line_number_ = 0;
  std::vector<Eigen::Vector3f> colours_;
  SourceScene scene_;
};

}  // namespace

SourceScene ReadAc3d(const std::filesystem::path& path) { return Reader(path).Read(); }

}  // namespace orb360::town
