#pragma once

#include <filesystem>

#include <orb360/slam/depth/sparse_sample.h>

namespace orb360 {

/// Writes one HDF5 file (docs/formats/sparse_depth.md): datasets `image` (height x width x 3,
/// uint8, RGB), `range` and `confidence` (height x width, float32, 0 = no point; range along the
/// ray in the map's units), and attributes `frame_index`, `timestamp` and `world_from_camera` (tx
/// ty tz qx qy qz qw). Throws UserError if the file cannot be written; no partial file remains.
void WriteSparseSample(const std::filesystem::path& path, const SparseSample& sample);

/// Reads such a file. Throws UserError for a file that is missing or has another form.
SparseSample ReadSparseSample(const std::filesystem::path& path);

}  // namespace orb360
