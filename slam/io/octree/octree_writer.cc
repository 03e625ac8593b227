#include "slam/io/octree/octree_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "slam/io/crc32.h"
#include "slam/io/octree/morton.h"
#include "slam/io/octree/octree_format.h"
#include "slam/io/octree/octree_levels.h"
#include "slam/io/octree/octree_normal.h"
#include "slam/io/octree/point_sorter.h"
#include "slam/io/ply.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

static_assert(std::endian::native == std::endian::little, "octrees are written byte by byte");

/// The cube around all points.
struct Cube {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  double side = 0;
  std::uint64_t count = 0;
};

Cube MeasureCube(const std::filesystem::path& cloud, const std::function<void()>& check) {
  Cube cube;
  Eigen::Vector3d max = -cube.min;
  ReadCloudPoints(cloud, [&](const SurfacePoint& point) {
    check();
    if (!point.position.allFinite()) {
      throw UserError(cloud.string() + ": point " + std::to_string(cube.count) +
                      " has no finite position; `orb360 run` makes the cloud anew");
    }
    cube.min = cube.min.cwiseMin(point.position.cast<double>());
    max = max.cwiseMax(point.position.cast<double>());
    ++cube.count;
  });
  if (cube.count == 0) {
    throw UserError(cloud.string() + ": has no points; there is nothing to make an octree of");
  }
  if (cube.count > std::numeric_limits<std::uint32_t>::max()) {
    throw UserError(cloud.string() + ": has more than 2^32 points; fuse it with larger voxels");
  }
  cube.side = (max - cube.min).maxCoeff();
  // Points that are all in one place, and the point at the upper end, need a cube as well.
  if (!(cube.side > 0)) cube.side = 1;
  return cube;
}

std::uint8_t ConfidenceByte(float confidence) {
  if (!(confidence > 0)) return 0;
  return static_cast<std::uint8_t>(std::clamp<long>(std::lround(255 * confidence), 1, 255));
}

/// Appends the values of an array as they lie in memory.
template <typename Value>
void AppendBytes(const std::vector<Value>& values, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// The points of a node as they are stored.
std::string Quantize(const OctreeLevels::Node& node, const OctreeNode& entry, const Cube& cube) {
  const double side = std::ldexp(cube.side, -node.level);
  const auto step = [&](float value, int axis) {
    const double at = (value - cube.min[axis]) / side - entry.cell[axis];
    return static_cast<std::uint16_t>(std::clamp(std::floor(at * 65536), 0.0, 65535.0));
  };
  std::vector<OctreePosition> positions;
  std::vector<OctreeColor> colors;
  for (const SortedPoint& point : node.points) {
    const auto& [x, y, z] = point.position;
    positions.push_back({step(x, 0), step(y, 1), step(z, 2), point.normal});
    colors.push_back({point.rgb[0], point.rgb[1], point.rgb[2], point.confidence});
  }
  std::string bytes;
  AppendBytes(positions, &bytes);
  AppendBytes(colors, &bytes);
  return bytes;
}

/// Place of a node in the index: level by level, within a level in the order of codes.
bool Precedes(const OctreeNode& a, const OctreeNode& b) {
  const auto code = [](const OctreeNode& n) { return MortonCode(n.cell[0], n.cell[1], n.cell[2]); };
  return std::tuple(a.level, code(a)) < std::tuple(b.level, code(b));
}

}  // namespace

std::uint64_t WriteOctree(const std::filesystem::path& path, const std::filesystem::path& cloud,
                          const OctreeOptions& options) {
  std::uint32_t num_checked = 0;
  const auto check = [&] {
    if (++num_checked % 65536 == 0 && options.check) options.check();
  };
  const Cube cube = MeasureCube(cloud, check);
  std::filesystem::path folder = path;
  folder += ".sort";
  PointSorter sorter(folder, options.max_in_memory);
  std::uint32_t num_read = 0;
  ReadCloudPoints(cloud, [&](const SurfacePoint& point) {
    check();
    SortedPoint sorted;
    sorted.code = MortonCode(point.position.cast<double>(), cube.min, cube.side);
    sorted.index = num_read++;
    sorted.position = {point.position.x(), point.position.y(), point.position.z()};
    sorted.normal = OctahedralNormal(point.normal);
    sorted.rgb = point.rgb;
    sorted.confidence = ConfidenceByte(point.confidence);
    sorter.Add(sorted);
  });

  OctreeHeader header{};
  std::memcpy(header.magic, kOctreeMagic.data(), sizeof header.magic);
  header.version = kOctreeVersion;
  header.attributes = IsSurfacePly(cloud) ? kOctreeNormals | kOctreeConfidences : 0;
  header.point_count = cube.count;
  header.cells_per_side = 1U << kOctreeCellBits;
  for (int axis = 0; axis < 3; ++axis) header.min[axis] = cube.min[axis];
  header.side = cube.side;

  AtomicFile file(path);
  std::string_view header_bytes(reinterpret_cast<const char*>(&header), sizeof header);
  file.Write(header_bytes);
  std::uint64_t offset = sizeof header;
  std::vector<OctreeNode> index;
  OctreeLevels levels([&](const OctreeLevels::Node& node) {
    OctreeNode entry{};
    entry.offset = offset;
    entry.point_count = static_cast<std::uint32_t>(node.points.size());
    for (int axis = 0; axis < 3; ++axis) entry.cell[axis] = GatherBits(node.code >> (2 - axis));
    entry.level = static_cast<std::uint8_t>(node.level);
    entry.children = node.children;
    const std::string bytes = Quantize(node, entry, cube);
    entry.crc = Crc32(bytes);
    file.Write(bytes);
    offset += bytes.size();
    index.push_back(entry);
  });
  sorter.Merge([&](const SortedPoint& point) {
    check();
    levels.Add(point);
  });
  levels.Finish();

  std::ranges::sort(index, Precedes);
  std::string index_bytes;
  AppendBytes(index, &index_bytes);
  file.Write(index_bytes);
  header.node_count = static_cast<std::uint32_t>(index.size());
  header.index_offset = offset;
  header.file_size = offset + index_bytes.size();
  header.index_crc = Crc32(index_bytes);
  header.header_crc = Crc32(header_bytes.substr(0, offsetof(OctreeHeader, header_crc)));
  file.Overwrite(0, header_bytes);
  file.Commit();
  return cube.count;
}

}  // namespace orb360
