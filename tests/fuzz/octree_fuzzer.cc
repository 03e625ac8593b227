// libFuzzer's target for what reads the header, the nodes and the points of an octree behind the
// checksums, which are made to fit: it must refuse with a UserError or give nodes whose points all
// lie between header and index, and finite positions; nothing else, whatever the bytes.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "slam/io/crc32.h"
#include "slam/io/octree/octree_format.h"
#include "slam/io/octree/octree_index.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Writes what the header states of the file such that only the rest decides.
std::string MakeFit(std::string_view bytes) {
  std::string file(bytes);
  OctreeHeader header{};
  std::memcpy(&header, file.data(), sizeof header);
  std::memcpy(header.magic, kOctreeMagic.data(), sizeof header.magic);
  header.version = kOctreeVersion;
  header.file_size = file.size();
  // The index: as many whole nodes as there are, up to 63.
  const size_t room = (file.size() - sizeof header) / sizeof(OctreeNode);
  header.node_count = static_cast<std::uint32_t>(std::min<size_t>(header.node_count % 64, room));
  header.index_offset = file.size() - header.node_count * sizeof(OctreeNode);
  header.index_crc = Crc32(std::string_view(file).substr(header.index_offset));
  const std::string_view checked(reinterpret_cast<const char*>(&header),
                                 offsetof(OctreeHeader, header_crc));
  header.header_crc = Crc32(checked);
  std::memcpy(file.data(), &header, sizeof header);
  return file;
}

void Read(std::string_view file) {
  const OctreeHeader header = ParseOctreeHeader(file, file.size(), "file");
  if (header.index_offset > file.size()) std::abort();
  const std::vector<OctreeNode> nodes =
      ParseOctreeIndex(header, file.substr(header.index_offset), "file");
  std::uint64_t num_points = 0;
  for (const OctreeNode& node : nodes) {
    const size_t bytes = node.point_count * kOctreePointBytes;
    if (node.offset + bytes > header.index_offset) std::abort();
    for (const SurfacePoint& point :
         ParseOctreePoints(header, node, file.substr(node.offset, bytes))) {
      if (!point.position.allFinite() || !point.normal.allFinite()) std::abort();
      ++num_points;
    }
  }
  if (nodes.empty() || num_points != header.point_count) std::abort();
}

void TryToRead(std::string_view file) {
  try {
    Read(file);
  } catch (const UserError&) {
    // The refusal of what is not allowed.
  }
}

}  // namespace
}  // namespace orb360

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  orb360::TryToRead(bytes);
  if (size >= sizeof(orb360::OctreeHeader)) orb360::TryToRead(orb360::MakeFit(bytes));
  return 0;
}
