#pragma once

#include <filesystem>

#include "nn/graph/graph.h"

namespace orb360::nn {

/// Reads a network (docs/networks.md). Throws UserError with one line that names the file, and the
/// node where it is one's fault, for a file that is missing, damaged, of another version or not
/// allowed. The HDF5 library only sees bytes whose digest is right. That library is not for several
/// threads: read one network at a time.
Graph ReadNetwork(const std::filesystem::path& path);

}  // namespace orb360::nn
