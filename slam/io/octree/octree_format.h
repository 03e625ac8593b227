#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace orb360 {

/// Name of the octree of a run's cloud, beside the cloud.
inline constexpr const char* kOctreeName = "cloud.octree";

/// The octree of a cloud in a file (docs/formats/octree.md). Numbers are little endian.
inline constexpr std::string_view kOctreeMagic = "ORB360OC";
inline constexpr std::uint32_t kOctreeVersion = 1;

/// Cells along a side of a node. A node has at most one point in each, unless it is a leaf.
inline constexpr int kOctreeCellBits = 6;
/// Levels below the root at most: cells of the deepest are the cells of the Morton code.
inline constexpr int kOctreeMaxLevel = 21 - kOctreeCellBits;
/// Cubes with no more points than this become leaves. A smaller number would make many files' worth
/// of requests, a larger one coarse steps in what a viewer shows.
inline constexpr std::uint32_t kOctreeLeafPoints = 8192;

/// What points have besides position and colour.
enum OctreeAttribute : std::uint32_t { kOctreeNormals = 1, kOctreeConfidences = 2 };

struct OctreeHeader {
  char magic[8];
  std::uint32_t version;
  std::uint32_t attributes;  ///< OctreeAttribute.
  std::uint64_t point_count;
  std::uint32_t node_count;
  std::uint32_t cells_per_side;  ///< 2^kOctreeCellBits.
  double min[3];                 ///< Corner of the root's cube in the world of the cloud.
  double side;                   ///< Length of an edge of this cube.
  std::uint64_t index_offset;    ///< First byte of the index.
  std::uint64_t file_size;
  std::uint32_t index_crc;   ///< CRC-32 of the index.
  std::uint32_t header_crc;  ///< CRC-32 of the header before this field.
};
static_assert(sizeof(OctreeHeader) == 88 && std::is_trivially_copyable_v<OctreeHeader>);

struct OctreeNode {
  std::uint64_t offset;       ///< First byte of its points.
  std::uint32_t point_count;  ///< Number of its points.
  std::uint32_t crc;          ///< CRC-32 of the bytes of its points.
  std::uint32_t cell[3];      ///< Its cube among the 2^level cubes along each axis of the root.
  std::uint8_t level;         ///< 0: the root.
  std::uint8_t children;      ///< Bit 4 x + 2 y + z is set where the child at that half exists.
  std::uint16_t zero;
};
static_assert(sizeof(OctreeNode) == 32 && std::is_trivially_copyable_v<OctreeNode>);

/// Position in the node's cube, in 2^-16 of its side from its corner; the centre of such a step is
/// meant. `normal`: OctahedralNormal, 0 without normals.
struct OctreePosition {
  std::uint16_t x, y, z, normal;
};

/// Colour, and confidence in 1/255, 0 without confidences.
struct OctreeColor {
  std::uint8_t red, green, blue, confidence;
};

/// Bytes of a point: first the positions of all points of a node, then their colours.
inline constexpr size_t kOctreePointBytes = sizeof(OctreePosition) + sizeof(OctreeColor);
static_assert(kOctreePointBytes == 12);

}  // namespace orb360
