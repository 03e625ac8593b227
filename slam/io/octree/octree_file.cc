#include "slam/io/octree/octree_file.h"

#include <cstdint>
#include <string>
#include <utility>

#include "slam/io/crc32.h"
#include "slam/io/octree/octree_index.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

OctreeFile::OctreeFile(std::filesystem::path path)
    : path_(std::move(path)), file_(path_, std::ios::binary) {
  if (!file_ || std::filesystem::is_directory(path_)) {
    throw UserError(path_.string() + ": cannot be opened; `orb360 view` makes it from cloud.ply");
  }
  std::string bytes(sizeof(OctreeHeader), '\0');
  file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(file_.gcount()));
  const std::uintmax_t size = std::filesystem::file_size(path_);
  header_ = ParseOctreeHeader(bytes, size, path_.string());
  bytes.resize(size - header_.index_offset);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(header_.index_offset));
  if (!file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    ThrowDamagedOctree(path_.string());
  }
  nodes_ = ParseOctreeIndex(header_, bytes, path_.string());
}

std::string OctreeFile::ReadBytes(const OctreeNode& node) const {
  std::string bytes(node.point_count * kOctreePointBytes, '\0');
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(node.offset));
  file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file_ || Crc32(bytes) != node.crc) ThrowDamagedOctree(path_.string());
  return bytes;
}

std::vector<SurfacePoint> OctreeFile::ReadPoints(const OctreeNode& node) const {
  return ParseOctreePoints(header_, node, ReadBytes(node));
}

}  // namespace orb360
