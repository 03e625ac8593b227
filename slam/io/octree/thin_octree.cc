#include "slam/io/octree/thin_octree.h"

#include <cstring>
#include <string_view>
#include <vector>

#include "slam/io/crc32.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Number of points of each level.
std::vector<std::uint64_t> CountByLevel(const OctreeFile& octree) {
  std::vector<std::uint64_t> counts(kOctreeMaxLevel + 1, 0);
  for (const OctreeNode& node : octree.nodes()) counts[node.level] += node.point_count;
  return counts;
}

/// The bytes of `kept` of `count` points, evenly spread over their order.
std::string KeepEvenly(const std::string& bytes, std::uint64_t count, std::uint64_t kept) {
  std::string positions;
  std::string colors;
  const std::string_view all_colors =
      std::string_view(bytes).substr(count * sizeof(OctreePosition));
  for (std::uint64_t i = 0; i < kept; ++i) {
    const std::uint64_t at = i * count / kept;
    positions.append(bytes, at * sizeof(OctreePosition), sizeof(OctreePosition));
    colors.append(all_colors.substr(at * sizeof(OctreeColor), sizeof(OctreeColor)));
  }
  return positions + colors;
}

template <typename Value>
void AppendBytes(const Value& value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string ThinOctree(const OctreeFile& octree, std::uint64_t max_points) {
  ORB360_CHECK(max_points > 0);
  const std::vector<std::uint64_t> counts = CountByLevel(octree);
  int last = 0;  // the level that is thinned
  std::uint64_t before = 0;
  while (last < kOctreeMaxLevel && before + counts[last] <= max_points) before += counts[last++];
  const std::uint64_t room = max_points - before;

  OctreeHeader header = octree.header();
  header.point_count = 0;
  std::string bytes(sizeof header, '\0');
  std::string index;
  std::uint64_t passed = 0;  // points of the last level so far
  for (const OctreeNode& node : octree.nodes()) {
    if (node.level > last) break;
    OctreeNode entry = node;
    std::string points = octree.ReadBytes(node);
    if (node.level == last) {
      entry.children = 0;
      if (counts[last] > room) {
        // As many as keep the sum of all nodes so far in proportion.
        const std::uint64_t end = passed + node.point_count;
        const std::uint64_t kept = end * room / counts[last] - passed * room / counts[last];
        points = KeepEvenly(points, node.point_count, kept);
        passed = end;
      }
    }
    entry.offset = bytes.size();
    entry.point_count = static_cast<std::uint32_t>(points.size() / kOctreePointBytes);
    entry.crc = Crc32(points);
    header.point_count += entry.point_count;
    bytes += points;
    AppendBytes(entry, &index);
  }
  header.node_count = static_cast<std::uint32_t>(index.size() / sizeof(OctreeNode));
  header.index_offset = bytes.size();
  header.file_size = bytes.size() + index.size();
  header.index_crc = Crc32(index);
  const std::string_view checked(reinterpret_cast<const char*>(&header),
                                 offsetof(OctreeHeader, header_crc));
  header.header_crc = Crc32(checked);
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes + index;
}

}  // namespace orb360
