#pragma once

#include <filesystem>

#include "slam/io/sparse_model.h"

namespace orb360 {

/// Name of the file in the folder of a run.
inline constexpr const char* kSparseModelName = "reconstruction.h5";

/// Writes one HDF5 file with a digest (docs/formats/reconstruction.md) atomically. The same model
/// gives the same bytes. Throws UserError on failure.
void WriteSparseModel(const std::filesystem::path& path, const SparseModel& model);

/// Reads such a file. Throws UserError with one line that names the file if it is missing, damaged,
/// of another version or not a reconstruction.
SparseModel ReadSparseModel(const std::filesystem::path& path);

}  // namespace orb360
