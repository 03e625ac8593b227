#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "slam/io/temporary_folder.h"

namespace orb360 {

/// A point of a cloud as an octree stores it, with its place in the order of Morton codes.
struct SortedPoint {
  std::uint64_t code = 0;   ///< MortonCode.
  std::uint32_t index = 0;  ///< Number in the cloud, which decides between equal codes.
  std::array<float, 3> position{};
  std::uint16_t normal = 0;  ///< OctahedralNormal.
  std::array<std::uint8_t, 3> rgb{};
  std::uint8_t confidence = 0;  ///< In 1/255.
};

/// Sorts points by their code and then their number, more of them than fit into memory: what is
/// full is sorted and written to a file of a temporary folder, and all files are merged at the end.
/// Throws UserError if the disk fails.
class PointSorter {
 public:
  /// `max_in_memory`: points held at once; 32 bytes each.
  PointSorter(std::filesystem::path folder, size_t max_in_memory);

  void Add(const SortedPoint& point);
  /// Passes on all points in their order. It is the last call.
  void Merge(const std::function<void(const SortedPoint&)>& take);

 private:
  void WritePiece();
  std::filesystem::path PathOf(size_t piece) const;

  const std::filesystem::path path_;
  const size_t max_in_memory_;
  std::vector<SortedPoint> points_;
  std::optional<TemporaryFolder> folder_;
  std::vector<std::uint64_t> pieces_;  // number of points of each file
};

}  // namespace orb360
