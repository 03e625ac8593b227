#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "slam/depth/surface_point.h"
#include "slam/io/octree/octree_format.h"

namespace orb360 {

/// An octree that WriteOctree wrote. Header and index are read and checked when it is opened, the
/// points of a node when they are asked for. Throws UserError with one line for a file that is
/// missing, truncated, damaged or of another version.
class OctreeFile {
 public:
  explicit OctreeFile(std::filesystem::path path);

  const OctreeHeader& header() const { return header_; }
  /// Level by level, the root first; within a level in the order of Morton codes.
  const std::vector<OctreeNode>& nodes() const { return nodes_; }

  /// The bytes of a node's points as they are stored.
  std::string ReadBytes(const OctreeNode& node) const;
  /// The points of a node, in the world of the cloud. What the cloud has not is 0.
  std::vector<SurfacePoint> ReadPoints(const OctreeNode& node) const;

 private:
  const std::filesystem::path path_;
  mutable std::ifstream file_;
  OctreeHeader header_{};
  std::vector<OctreeNode> nodes_;
};

}  // namespace orb360
