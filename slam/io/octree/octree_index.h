#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slam/depth/surface_point.h"
#include "slam/io/octree/octree_format.h"

namespace orb360 {

/// Reads the header of an octree from the first bytes of a file of the given size. Throws UserError
/// with one line that begins with `name` for a file that is no octree, is truncated, damaged, or of
/// another version.
OctreeHeader ParseOctreeHeader(std::string_view bytes, std::uint64_t file_size,
                               const std::string& name);

/// Reads the index, the bytes of the file from header.index_offset on. Throws UserError as above
/// for one that is damaged. Otherwise the points of each node lie between header and index.
std::vector<OctreeNode> ParseOctreeIndex(const OctreeHeader& header, std::string_view bytes,
                                         const std::string& name);

/// Reads the points of a node, in the world of the cloud; what the cloud has not is 0. Contract:
/// there are kOctreePointBytes bytes a point.
std::vector<SurfacePoint> ParseOctreePoints(const OctreeHeader& header, const OctreeNode& node,
                                            std::string_view bytes);

/// The error of a file that is damaged.
[[noreturn]] void ThrowDamagedOctree(const std::string& name);

}  // namespace orb360
