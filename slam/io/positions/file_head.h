#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace orb360 {

/// Reads the first `max_bytes` of a file, or all of a shorter one. Throws UserError for one that
/// cannot be opened or is empty.
std::string ReadFileHead(const std::filesystem::path& path, size_t max_bytes);

/// Reads a file. Throws UserError as ReadFileHead does, and for one that is larger than
/// `max_bytes`, before any memory is taken.
std::string ReadWholeFile(const std::filesystem::path& path, size_t max_bytes);

}  // namespace orb360
