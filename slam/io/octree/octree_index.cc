#include "slam/io/octree/octree_index.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "slam/io/crc32.h"
#include "slam/io/octree/octree_normal.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

static_assert(std::endian::native == std::endian::little, "octrees are read byte by byte");

/// Whether all that a header and its nodes tell can be so.
bool IsConsistent(const OctreeHeader& header, const std::vector<OctreeNode>& nodes) {
  if (!(header.side > 0) || header.cells_per_side == 0) return false;
  for (const double min : header.min) {  // Positions are floats.
    if (!(std::abs(min) + header.side <= std::numeric_limits<float>::max())) return false;
  }
  if (nodes.empty() || nodes.front().level != 0) return false;
  std::uint64_t points = 0;
  for (const OctreeNode& node : nodes) {
    const std::uint64_t bytes = std::uint64_t{node.point_count} * kOctreePointBytes;
    if (node.level > kOctreeMaxLevel || node.offset < sizeof(OctreeHeader) ||
        node.offset > header.index_offset || bytes > header.index_offset - node.offset) {
      return false;
    }
    for (const std::uint32_t cell : node.cell) {
      if (cell >= 1U << node.level) return false;
    }
    points += node.point_count;
  }
  return points == header.point_count;
}

}  // namespace

void ThrowDamagedOctree(const std::string& name) {
  throw UserError(name +
                  ": is no octree of a cloud, or is damaged; delete it, and `orb360 view` makes it "
                  "anew");
}

OctreeHeader ParseOctreeHeader(std::string_view bytes, std::uint64_t file_size,
                               const std::string& name) {
  OctreeHeader header{};
  if (bytes.size() < sizeof header) ThrowDamagedOctree(name);
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::string_view(header.magic, sizeof header.magic) != kOctreeMagic) ThrowDamagedOctree(name);
  if (header.version != kOctreeVersion) {
    throw UserError(name + ": has version " + std::to_string(header.version) +
                    " of the format, and this program reads version " +
                    std::to_string(kOctreeVersion) +
                    "; delete it, and `orb360 view` makes it anew");
  }
  if (header.header_crc != Crc32(bytes.substr(0, offsetof(OctreeHeader, header_crc)))) {
    ThrowDamagedOctree(name);
  }
  if (file_size != header.file_size) {
    throw UserError(name + ": is truncated: it has " + std::to_string(file_size) + " of " +
                    std::to_string(header.file_size) +
                    " bytes; delete it, and `orb360 view` makes it anew");
  }
  const std::uint64_t index_bytes = std::uint64_t{header.node_count} * sizeof(OctreeNode);
  if (header.index_offset > file_size || file_size - header.index_offset != index_bytes) {
    ThrowDamagedOctree(name);
  }
  return header;
}

std::vector<OctreeNode> ParseOctreeIndex(const OctreeHeader& header, std::string_view bytes,
                                         const std::string& name) {
  if (bytes.size() != std::uint64_t{header.node_count} * sizeof(OctreeNode) ||
      header.index_crc != Crc32(bytes)) {
    ThrowDamagedOctree(name);
  }
  std::vector<OctreeNode> nodes(header.node_count);
  if (!nodes.empty()) std::memcpy(nodes.data(), bytes.data(), bytes.size());
  if (!IsConsistent(header, nodes)) ThrowDamagedOctree(name);
  return nodes;
}

std::vector<SurfacePoint> ParseOctreePoints(const OctreeHeader& header, const OctreeNode& node,
                                            std::string_view bytes) {
  ORB360_CHECK(bytes.size() == node.point_count * kOctreePointBytes, bytes.size());
  const double side = std::ldexp(header.side, -node.level);
  std::vector<SurfacePoint> points(node.point_count);
  for (size_t i = 0; i < points.size(); ++i) {
    OctreePosition position{};
    OctreeColor color{};
    std::memcpy(&position, bytes.data() + i * sizeof position, sizeof position);
    std::memcpy(&color, bytes.data() + points.size() * sizeof position + i * sizeof color,
                sizeof color);
    const std::uint16_t steps[3] = {position.x, position.y, position.z};
    for (int axis = 0; axis < 3; ++axis) {
      points[i].position[axis] = static_cast<float>(
          header.min[axis] + side * (node.cell[axis] + (steps[axis] + 0.5) / 65536));
    }
    points[i].normal = NormalFromOctahedral(position.normal);
    points[i].rgb = {color.red, color.green, color.blue};
    points[i].confidence = static_cast<float>(color.confidence) / 255.0f;
  }
  return points;
}

}  // namespace orb360
