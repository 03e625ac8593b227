#pragma once

#include <filesystem>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Reads a network (docs/formats/network.md). Throws UserError with one line that names the file,
/// and the node if it is at fault, if the file is missing, damaged, of another version or not
/// allowed. The HDF5 library sees only bytes whose digest is correct. It is not thread-safe: read
/// one network at a time.
Graph ReadNetwork(const std::filesystem::path& path);

}  // namespace orb360::nn
