#include "apps/town/import/quake_bsp.h"

#include <array>
#include <string_view>

#include "apps/town/import/file_bytes.h"

namespace orb360::town {
namespace {

/// The lumps that are read, by their number in the directory.
enum Lump : size_t {
  kEntities = 0,
  kShaders = 1,
  kModels = 7,
  kVertices = 10,
  kIndices = 11,
  kFaces = 13,
  kLightPages = 14,
};
constexpr size_t kLumpCount = 17;

/// The largest coordinate, in units; Quake allows half of it.
constexpr float kFarthest = 1 << 18;
/// The largest texture coordinate, in tiles.
constexpr float kMaxTiles = 1 << 16;

constexpr size_t kMaxCorners = 20'000'000;

class MapReader {
 public:
  explicit MapReader(const std::filesystem::path& path) : file_(path) {
    if (file_.size() < 4 || file_.Text(0, 4) != "IBSP")
      file_.Refuse("is not a map of Quake 3: it does not begin with IBSP");
    constexpr int kVersion = 46;
    const int version = file_.Int(4);
    if (version != kVersion) {
      file_.Refuse("is a map of version " + std::to_string(version) +
                   ": only version 46, of Quake 3, is read");
    }
    for (size_t i = 0; i < kLumpCount; ++i) {
      lumps_[i] = {file_.Word(8 + 8 * i), file_.Word(12 + 8 * i)};
      file_.From(lumps_[i].offset, lumps_[i].length);
    }
  }

  QuakeMap Read() {
    map_.entities =
        ParseQuakeEntities(file_.Text(lumps_[kEntities].offset, lumps_[kEntities].length));
    ReadShaders();
    ReadVertices();
    for (const size_t at : Records(kIndices, 4)) map_.indices.push_back(file_.Word(at));
    ReadFaces();
    ReadModels();
    Records(kLightPages, kLightPageBytes);
    const auto pages = file_.From(lumps_[kLightPages].offset, lumps_[kLightPages].length);
    map_.light_pages.assign(pages.begin(), pages.end());
    RequireLightPages();
    return std::move(map_);
  }

 private:
  struct Extent {
    size_t offset = 0;
    size_t length = 0;
  };

  [[noreturn]] void Damaged(const std::string& what) const {
    file_.Refuse("is damaged: " + what + ": unpack or copy it again");
  }

  /// Returns the offsets of a lump's records.
  std::vector<size_t> Records(Lump lump, size_t size) const {
    const Extent& extent = lumps_[lump];
    if (extent.length % size != 0)
      Damaged("lump " + std::to_string(lump) + " does not hold whole records");
    std::vector<size_t> offsets;
    for (size_t at = 0; at < extent.length; at += size) offsets.push_back(extent.offset + at);
    return offsets;
  }

  void ReadShaders() {
    for (const size_t at : Records(kShaders, 72)) {
      const std::string_view name = file_.Text(at, 64);
      map_.shaders.push_back(
          {std::string(name.substr(0, name.find('\0'))), file_.Word(at + 64), file_.Word(at + 68)});
    }
  }

  template <int N>
  Eigen::Vector<float, N> Floats(size_t at, float limit, const char* what) const {
    Eigen::Vector<float, N> v;
    for (int i = 0; i < N; ++i) v[i] = file_.Float(at + 4 * static_cast<size_t>(i));
    if (!v.allFinite() || v.cwiseAbs().maxCoeff() > limit)
      Damaged(std::string(what) + " of a vertex is out of range");
    return v;
  }

  void ReadVertices() {
    for (const size_t at : Records(kVertices, 44)) {
      QuakeVertex& vertex = map_.vertices.emplace_back();
      vertex.position = Floats<3>(at, kFarthest, "the position");
      vertex.uv = Floats<2>(at + 12, kMaxTiles, "the texture coordinate");
      // Where a face has no page of light, any number may stand here.
      for (int i = 0; i < 2; ++i) {
        const float u = file_.Float(at + 20 + 4 * static_cast<size_t>(i));
        vertex.light_uv[i] = u >= 0 && u <= 1 ? u : (u > 1 ? 1.0F : 0.0F);
      }
      vertex.normal = Floats<3>(at + 28, 1e3F, "the normal");
      for (size_t i = 0; i < 3; ++i)
        vertex.colour[static_cast<int>(i)] = static_cast<float>(file_.Byte(at + 40 + i));
    }
  }

  /// Reads a number that must not be negative.
  size_t Count(size_t at, const char* what) const {
    const int32_t count = file_.Int(at);
    if (count < 0) Damaged(std::string(what) + " is negative");
    return static_cast<size_t>(count);
  }

  void RequireRange(size_t first, size_t count, size_t size, const char* what) const {
    if (first > size || count > size - first)
      Damaged(std::string(what) + " that does not exist is named");
  }

  void ReadFaces() {
    for (const size_t at : Records(kFaces, 104)) {
      QuakeFace face;
      const int32_t kind = file_.Int(at + 8);
      if (kind < 1 || kind > 4) {
        // The compiler also writes kinds of its own (such as grass), which the game ignores.
        face.kind = QuakeFaceKind::kBillboard;
      } else {
        face.kind = static_cast<QuakeFaceKind>(kind);
      }
      face.shader = Count(at, "the number of a surface");
      RequireRange(face.shader, 1, map_.shaders.size(), "a surface");
      if (face.kind != QuakeFaceKind::kBillboard) ReadGeometry(at, &face);
      map_.faces.push_back(face);
    }
  }

  void ReadGeometry(size_t at, QuakeFace* face) {
    face->first_vertex = Count(at + 12, "the first vertex of a face");
    face->vertex_count = Count(at + 16, "the number of vertices of a face");
    RequireRange(face->first_vertex, face->vertex_count, map_.vertices.size(), "a vertex");
    // Faces may share vertices, but not so that few bytes become many.
    corners_ += face->vertex_count;
    if (corners_ > kMaxCorners) Damaged("its faces have too many vertices");
    face->light_page = file_.Int(at + 28);
    if (face->kind == QuakeFaceKind::kPatch) {
      const size_t width = Count(at + 96, "the width of a patch");
      const size_t height = Count(at + 100, "the height of a patch");
      constexpr size_t kMaxSide = 63;  // Quake allows 31
      if (width < 3 || height < 3 || width > kMaxSide || height > kMaxSide || width % 2 == 0 ||
          height % 2 == 0 || width > face->vertex_count || height > face->vertex_count / width)
        Damaged("a patch has an impossible size");
      face->patch_width = width;
      face->patch_height = height;
      return;
    }
    face->first_index = Count(at + 20, "the first corner of a face");
    face->index_count = Count(at + 24, "the number of corners of a face");
    RequireRange(face->first_index, face->index_count, map_.indices.size(), "a corner");
    corners_ += face->index_count;
    if (corners_ > kMaxCorners) Damaged("its faces have too many corners");
    if (face->index_count % 3 != 0) Damaged("the corners of a face are no triangles");
    for (size_t i = 0; i < face->index_count; ++i) {
      if (map_.indices[face->first_index + i] >= face->vertex_count)
        Damaged("a corner of a face is none of its vertices");
    }
  }

  void ReadModels() {
    for (const size_t at : Records(kModels, 40)) {
      const QuakeModel model{Count(at + 24, "the first face of a model"),
                             Count(at + 28, "the number of faces of a model")};
      RequireRange(model.first_face, model.face_count, map_.faces.size(), "a face");
      map_.models.push_back(model);
    }
    if (map_.models.empty()) Damaged("it contains no model");
  }

  /// Faces with pages in other files, which are not read, take the colours of their vertices.
  void RequireLightPages() {
    const auto pages = static_cast<int64_t>(map_.light_pages.size() / kLightPageBytes);
    for (QuakeFace& face : map_.faces) {
      if (face.light_page < pages) continue;
      if (pages > 0) Damaged("a page of light that does not exist is named");
      face.light_page = -1;
    }
  }

  FileBytes file_;
  std::array<Extent, kLumpCount> lumps_{};
  QuakeMap map_;
  size_t corners_ = 0;  // and vertices, of all faces
};

}  // namespace

QuakeMap ReadQuakeMap(const std::filesystem::path& path) { return MapReader(path).Read(); }

}  // namespace orb360::town
