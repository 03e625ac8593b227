#pragma once

#include <cstdint>
#include <string>

#include "slam/io/octree/octree_file.h"

namespace orb360 {

/// Returns the bytes of an octree (docs/formats/octree.md) with at most `max_points` points of
/// another one, 1 or more: its coarsest levels, and of the first level that does not fit as a whole
/// every n-th point of each node. Throws UserError for a damaged file.
std::string ThinOctree(const OctreeFile& octree, std::uint64_t max_points);

}  // namespace orb360
