#include "apps/town/import/spm_mesh.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>

#include <Eigen/Core>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

static_assert(std::endian::native == std::endian::little, "SPM files are little-endian");

/// Kinds of mesh, in the lower three bits of the third byte; the version is above them.
enum class Kind : uint8_t { kAnimated = 1, kStatic = 2 };

constexpr unsigned kVersion = 1;

/// Reads values from the bytes of a file, never beyond their end.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw UserError(path.string() + ": cannot be opened");
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }

  std::vector<SpmPart> Read() {
    if (Take(2) != "SP") Refuse("is not an SPM mesh: it does not begin with SP");
    const unsigned kind_and_version = Number<uint8_t>();
    if (const unsigned version = kind_and_version >> 3; version != kVersion) {
      Refuse("is of version " + std::to_string(version) + " of SPM; only version 1 is read");
    }
    kind_ = static_cast<Kind>(kind_and_version & 7U);
    if (kind_ != Kind::kAnimated && kind_ != Kind::kStatic)
      Refuse("is of a kind of SPM mesh that is not read");
    const unsigned flags = Number<uint8_t>();
    has_normals_ = (flags & 1U) != 0;
    has_colours_ = (flags & 2U) != 0;
    has_tangents_ = (flags & 4U) != 0;
    Take(6 * sizeof(float));  // the bounding box
    std::vector<Textures> textures(Number<uint16_t>());
    for (Textures& pair : textures) pair = {Text(), Text()};
    std::vector<SpmPart> parts;
    const unsigned sectors = Number<uint16_t>();
    for (unsigned sector = 0; sector < sectors; ++sector) {
      const unsigned count = Number<uint16_t>();
      for (unsigned i = 0; i < count; ++i) parts.push_back(ReadPart(textures));
    }
    // Joints and their movements follow in an animated mesh.
    if (kind_ == Kind::kStatic && next_ != bytes_.size())
      Refuse("has bytes after its last mesh: it may be damaged; use an unchanged copy");
    return parts;
  }

 private:
  /// The names of the textures of a surface; empty for none.
  struct Textures {
    std::string first;
    std::string second;
  };

  [[noreturn]] void Refuse(const std::string& reason) const {
    throw UserError(path_.string() + ": " + reason);
  }
  std::string_view Take(size_t count) {
    if (count > bytes_.size() - next_) Refuse("ends too early: use an unchanged copy");
    const std::string_view taken(bytes_.data() + next_, count);
    next_ += count;
    return taken;
  }
  template <typename T>
  T Number() {
    T value;
    std::memcpy(&value, Take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string Text() { return std::string(Take(Number<uint8_t>())); }
  float Half() {
    return static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(Number<uint16_t>()));
  }

  SpmPart ReadPart(const std::vector<Textures>& textures) {
    const auto vertices = Number<uint32_t>();
    const auto indices = Number<uint32_t>();
    const auto material = Number<uint16_t>();
    if (material >= textures.size()) Refuse("a mesh has a material that the file does not list");
    SpmPart part{.texture = textures[material].first, .mesh = {}};
    // Memory is reserved as the vertices are read, because a damaged file may state any number.
    for (uint32_t i = 0; i < vertices; ++i) ReadVertex(textures[material], &part.mesh);
    if (indices % 3 != 0) Refuse("a mesh has a number of corners that is not a multiple of 3");
    const auto index = [&]() -> uint32_t {
      const uint32_t value = vertices > 255 ? Number<uint16_t>() : Number<uint8_t>();
      if (value >= vertices) Refuse("a triangle has a corner that does not exist");
      return value;
    };
    for (uint32_t i = 0; i < indices; i += 3) {
      const uint32_t a = index();
      const uint32_t b = index();
      const uint32_t c = index();
      part.mesh.triangles.push_back({a, b, c});
    }
    return part;
  }

  void ReadVertex(const Textures& textures, SourceMesh* mesh) {
    Eigen::Vector3f position;
    for (int axis = 0; axis < 3; ++axis) position[axis] = Number<float>();
    if (!position.allFinite()) Refuse("a vertex has a position that is not a number");
    mesh->positions.push_back(position);
    if (has_normals_) mesh->normals.push_back(UnpackNormal(Number<uint32_t>()));
    if (has_colours_) {
      constexpr uint8_t kWhite = 128;  // no colour follows
      Eigen::Vector3f colour = Eigen::Vector3f::Ones();
      if (Number<uint8_t>() != kWhite) {
        for (int k = 0; k < 3; ++k) colour[k] = static_cast<float>(Number<uint8_t>()) / 255;
      }
      mesh->colours.push_back(colour);
    }
    if (!textures.first.empty()) {
      const float u = Half();
      const float v = Half();
      const bool is_finite = std::isfinite(u) && std::isfinite(v);
      mesh->texture_coordinates.emplace_back(is_finite ? u : 0, is_finite ? 1 - v : 0);
      if (!textures.second.empty()) Take(2 * sizeof(uint16_t));
      if (has_tangents_) Take(sizeof(uint32_t));
    }
    // Four joints with their weights. Positions are those of the rest pose.
    if (kind_ == Kind::kAnimated) Take(8 * sizeof(uint16_t));
  }

  /// Unpacks three signed numbers of ten bits each, the first in the lowest bits.
  static Eigen::Vector3f UnpackNormal(uint32_t packed) {
    Eigen::Vector3f normal;
    for (int axis = 0; axis < 3; ++axis) {
      const auto bits = static_cast<int32_t>(packed << (22 - 10 * axis));
      normal[axis] = static_cast<float>(bits >> 22) / 511;
    }
    normal.stableNormalize();
    return normal.squaredNorm() > 0.5F ? normal : Eigen::Vector3f::UnitY();
  }

  std::filesystem::path path_;
  std::string bytes_;
  size_t next_ = 0;
  Kind kind_ = Kind::kStatic;
  bool has_normals_ = false;
  bool has_colours_ = false;
  bool has_tangents_ = false;
};

}  // namespace

std::vector<SpmPart> ReadSpm(const std::filesystem::path& path) { return Reader(path).Read(); }

}  // namespace orb360::town
