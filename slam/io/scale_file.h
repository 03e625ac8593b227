#pragma once

#include <filesystem>
#include <span>
#include <vector>

namespace orb360 {

/// The scale of the path at a time, as `scale.txt` of a run has it.
struct StampedScale {
  double timestamp = 0;  ///< Seconds.
  double value = 1;      ///< Estimated metres in a unit of the path.
  double sigma = 0;      ///< Standard deviation of ln(value).
};

/// Writes a whole file: a comment, then lines `timestamp value sigma`. Throws UserError.
void WriteScales(const std::filesystem::path& path, std::span<const StampedScale> scales);

/// Reads the lines of a file, in its order. Throws UserError with file and line for one that is not
/// a time and two positive numbers, and for a file that cannot be opened.
std::vector<StampedScale> ReadScales(const std::filesystem::path& path);

}  // namespace orb360
