#include "slam/io/mesh_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kTileCells = 256;
constexpr int kMaxIndex = 1 << 20;
constexpr size_t kChunkBytes = size_t{1} << 20;
constexpr size_t kTriangleBytes = 1 + 3 * sizeof(std::uint32_t);

// Three indices of 21 bits.
std::uint64_t KeyOf(const CellIndex& index) {
  std::uint64_t key = 0;
  for (int axis = 2; axis >= 0; --axis) {
    key = key << 21 | static_cast<std::uint64_t>(index[axis] + kMaxIndex);
  }
  return key;
}

CellIndex IndexOf(std::uint64_t key) {
  CellIndex index;
  for (std::int32_t& value : index) {
    value = static_cast<std::int32_t>(key & ((1U << 21) - 1)) - kMaxIndex;
    key >>= 21;
  }
  return index;
}

template <typename T>
void AppendBytes(const T* values, size_t count, std::string* buffer) {
  buffer->append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

// The index of the vertex of each cell. Ordered by cell once all are in.
class VertexIndex {
 public:
  void Add(const CellIndex& cell, std::uint32_t vertex) {
    entries_.emplace_back(KeyOf(cell), vertex);
  }
  void Sort() { std::ranges::sort(entries_); }
  std::uint32_t Find(const CellIndex& cell) const {
    const auto found = std::ranges::lower_bound(entries_, KeyOf(cell), {}, &Entry::first);
    ORB360_CHECK(found != entries_.end() && found->first == KeyOf(cell), cell[0], cell[1], cell[2]);
    return found->second;
  }

 private:
  using Entry = std::pair<std::uint64_t, std::uint32_t>;
  std::vector<Entry> entries_;
};

// Triangles as they stand in the file.
class TriangleFile {
 public:
  explicit TriangleFile(const std::filesystem::path& path) : file_(path) {}

  void Add(const std::array<CellIndex, 3>& triangle, const VertexIndex& vertices) {
    buffer_ += '\3';
    for (const CellIndex& cell : triangle) {
      const std::uint32_t vertex = vertices.Find(cell);
      AppendBytes(&vertex, 1, &buffer_);
    }
    ++count_;
    if (buffer_.size() >= kChunkBytes) Flush();
  }
  void Flush() {
    file_.Write(buffer_);
    buffer_.clear();
  }
  std::uint64_t count() const { return count_; }
  const std::filesystem::path& path() const { return file_.path(); }

 private:
  OutputFile file_;
  std::string buffer_;
  std::uint64_t count_ = 0;
};

// All headers have the same length.
std::string Header(const MeshSummary& counts) {
  const auto padded = [](std::uint64_t number) {
    std::string text = std::to_string(number);
    text.resize(20, ' ');
    return text;
  };
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + padded(counts.vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property float nx\nproperty float ny\nproperty float nz\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face " +
         padded(counts.triangles) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

MeshWriter::MeshWriter(const std::filesystem::path& path, double cell_size,
                       const SurfaceNetsOptions& options, int num_threads)
    : path_(path),
      cell_size_(cell_size),
      options_(options),
      num_threads_(num_threads),
      tiles_(path.string() + ".points") {
  ORB360_CHECK(cell_size > 0, cell_size);
}

void MeshWriter::Add(std::span<const SurfacePoint> points) {
  const int margin = SurfaceMargin(options_);
  std::map<std::uint64_t, std::vector<Record>> by_tile;
  for (const SurfacePoint& point : points) {
    const Eigen::Vector3f& p = point.position;
    const Eigen::Vector3f& n = point.normal;
    const Record record{{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, point.rgb, point.confidence};
    CellIndex low;
    CellIndex high;
    bool is_near = true;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::floor(static_cast<double>(point.position[axis]) / cell_size_);
      is_near = is_near && std::abs(cell) < kMaxIndex - kTileCells;
      if (!is_near) break;
      const auto tile_of = [](double index) {
        return static_cast<std::int32_t>(std::floor(index / kTileCells));
      };
      low[axis] = tile_of(cell - margin);
      high[axis] = tile_of(cell + margin);
    }
    if (!is_near) continue;
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) by_tile[KeyOf({x, y, z})].push_back(record);
      }
    }
  }
  for (const auto& [tile, part] : by_tile) tiles_.Append(tile, part);
}

MeshSummary MeshWriter::Write() const {
  MeshSummary summary;
  AtomicFile file(path_);
  file.Write(Header(summary));
  TriangleFile triangles(tiles_.folder() / "triangles");
  VertexIndex border;                            // Where cubes meet.
  std::vector<std::array<CellIndex, 3>> across;  // Triangles that go from one into another.
  tiles_.ForEach([&](std::uint64_t tile, const std::vector<Record>& records) {
    std::vector<SurfacePoint> points;
    points.reserve(records.size());
    for (const Record& record : records) {
      points.push_back({Eigen::Vector3f(record.position.data()),
                        Eigen::Vector3f(record.normal.data()), record.rgb, record.confidence});
    }
    CellIndex first = IndexOf(tile);
    for (std::int32_t& index : first) index *= kTileCells;
    const SurfacePart part =
        ExtractSurface(points, first, kTileCells, cell_size_, options_, num_threads_);
    if (summary.vertices + part.vertices.size() > (std::uint64_t{1} << 31) - 1) {
      throw UserError(path_.string() + ": has too many vertices; take a larger --voxel-size");
    }
    VertexIndex inside;
    std::string buffer;
    for (size_t i = 0; i < part.vertices.size(); ++i) {
      const SurfacePoint& vertex = part.vertices[i];
      AppendBytes(vertex.position.data(), 3, &buffer);
      AppendBytes(vertex.normal.data(), 3, &buffer);
      AppendBytes(vertex.rgb.data(), 3, &buffer);
      const auto index = static_cast<std::uint32_t>(summary.vertices + i);
      inside.Add(part.cells[i], index);
      bool is_at_border = false;
      for (int axis = 0; axis < 3; ++axis) {
        const int local = part.cells[i][axis] - first[axis];
        is_at_border = is_at_border || local == 0 || local == kTileCells - 1;
      }
      if (is_at_border) border.Add(part.cells[i], index);
    }
    file.Write(buffer);
    summary.vertices += part.vertices.size();
    inside.Sort();
    for (const std::array<CellIndex, 3>& triangle : part.triangles) {
      const bool is_inside = std::ranges::all_of(triangle, [&first](const CellIndex& cell) {
        return cell[0] >= first[0] && cell[1] >= first[1] && cell[2] >= first[2];
      });
      if (is_inside) {
        triangles.Add(triangle, inside);
      } else {
        across.push_back(triangle);
      }
    }
  });
  border.Sort();
  for (const std::array<CellIndex, 3>& triangle : across) triangles.Add(triangle, border);
  triangles.Flush();
  summary.triangles = triangles.count();
  std::ifstream stored(triangles.path(), std::ios::binary);
  std::string chunk(kChunkBytes, '\0');
  std::uint64_t num_bytes = 0;
  while (stored) {
    stored.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    file.Write(std::string_view(chunk).substr(0, static_cast<size_t>(stored.gcount())));
    num_bytes += static_cast<std::uint64_t>(stored.gcount());
  }
  if (num_bytes != kTriangleBytes * summary.triangles) {
    throw UserError(triangles.path().string() +
                    ": is damaged or gone; keep the folder as it is until the mesh is written");
  }
  file.Overwrite(0, Header(summary));
  file.Commit();
  return summary;
}

}  // namespace orb360
