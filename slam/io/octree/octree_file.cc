#include "slam/io/octree/octree_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "slam/io/crc32.h"
#include "slam/io/octree/octree_normal.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

UserError Damaged(const std::filesystem::path& path) {
  return UserError(
      path.string() +
      ": is no octree of a cloud, or is damaged; delete it, and `orb360 view` makes it "
      "anew");
}

template <typename Value>
std::string_view BytesOf(const Value& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

}  // namespace

OctreeFile::OctreeFile(std::filesystem::path path)
    : path_(std::move(path)), file_(path_, std::ios::binary) {
  if (!file_ || std::filesystem::is_directory(path_)) {
    throw UserError(path_.string() + ": cannot be opened; `orb360 view` makes it from cloud.ply");
  }
  if (!file_.read(reinterpret_cast<char*>(&header_), sizeof header_)) throw Damaged(path_);
  if (std::string_view(header_.magic, sizeof header_.magic) != kOctreeMagic) throw Damaged(path_);
  if (header_.version != kOctreeVersion) {
    throw UserError(path_.string() + ": has version " + std::to_string(header_.version) +
                    " of the format, and this program reads version " +
                    std::to_string(kOctreeVersion) +
                    "; delete it, and `orb360 view` makes it anew");
  }
  const auto checked = BytesOf(header_).substr(0, offsetof(OctreeHeader, header_crc));
  if (header_.header_crc != Crc32(checked)) throw Damaged(path_);
  const std::uintmax_t size = std::filesystem::file_size(path_);
  if (size != header_.file_size) {
    throw UserError(path_.string() + ": is truncated: it has " + std::to_string(size) + " of " +
                    std::to_string(header_.file_size) +
                    " bytes; delete it, and `orb360 view` makes it anew");
  }
  const std::uint64_t index_bytes = std::uint64_t{header_.node_count} * sizeof(OctreeNode);
  if (header_.index_offset > size || size - header_.index_offset != index_bytes) {
    throw Damaged(path_);
  }
  nodes_.resize(header_.node_count);
  file_.seekg(static_cast<std::streamoff>(header_.index_offset));
  file_.read(reinterpret_cast<char*>(nodes_.data()), static_cast<std::streamsize>(index_bytes));
  const std::string_view index(reinterpret_cast<const char*>(nodes_.data()), index_bytes);
  if (!file_ || header_.index_crc != Crc32(index)) throw Damaged(path_);
  Check();
}

void OctreeFile::Check() const {
  bool is_good = header_.side > 0 && std::isfinite(header_.side) && !nodes_.empty() &&
                 nodes_.front().level == 0 && header_.cells_per_side > 0;
  for (const double min : header_.min) is_good = is_good && std::isfinite(min);
  std::uint64_t points = 0;
  for (const OctreeNode& node : nodes_) {
    const std::uint64_t bytes = std::uint64_t{node.point_count} * kOctreePointBytes;
    is_good = is_good && node.level <= kOctreeMaxLevel && node.offset >= sizeof(OctreeHeader) &&
              node.offset <= header_.index_offset && bytes <= header_.index_offset - node.offset;
    for (const std::uint32_t cell : node.cell) is_good = is_good && cell < 1U << node.level;
    points += node.point_count;
  }
  if (!is_good || points != header_.point_count) throw Damaged(path_);
}

std::string OctreeFile::ReadBytes(const OctreeNode& node) const {
  std::string bytes(node.point_count * kOctreePointBytes, '\0');
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(node.offset));
  file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file_ || Crc32(bytes) != node.crc) throw Damaged(path_);
  return bytes;
}

std::vector<SurfacePoint> OctreeFile::ReadPoints(const OctreeNode& node) const {
  const std::string bytes = ReadBytes(node);
  const double side = std::ldexp(header_.side, -node.level);
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
          header_.min[axis] + side * (node.cell[axis] + (steps[axis] + 0.5) / 65536));
    }
    points[i].normal = NormalFromOctahedral(position.normal);
    points[i].rgb = {color.red, color.green, color.blue};
    points[i].confidence = static_cast<float>(color.confidence) / 255.0f;
  }
  return points;
}

}  // namespace orb360
