#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace orb360 {

/// Returns the octree of the cloud in the folder of a run. Where it is missing, or older than the
/// cloud, it is made first, and `is_quiet` false says so on standard output. None for a run without
/// a cloud, or with an empty one, or in a folder that cannot be written to; a sentence in `missing`
/// says so. Throws UserError for a damaged cloud and if the disk fails, Interrupted after an
/// interrupt.
std::optional<std::filesystem::path> ProvideOctree(const std::filesystem::path& run, bool is_quiet,
                                                   std::vector<std::string>* missing);

}  // namespace orb360
