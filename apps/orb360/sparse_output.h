#pragma once

#include <filesystem>
#include <span>

#include <orb360/slam/depth/sparse_sample.h>
#include <orb360/slam/io/sequence.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

inline constexpr const char* kSparseName = "sparse";

/// Creates `folder`/sparse and removes what an earlier run has written there. Returns it. Throws
/// UserError where that fails.
std::filesystem::path MakeSparseFolder(const std::filesystem::path& folder);

/// Writes what the network completes to `folder`/000123.h5, named by the frame index
/// (WriteSparseSample). Throws UserError where the file cannot be written.
void WriteSparseView(const std::filesystem::path& folder, const SparseSample& sample);

/// Writes the image of every keyframe with its sparse ranges and their confidence to
/// `folder` in the same way. `sequence` is the input of the
/// run, opened again because a run does not keep its images. Throws UserError where a file cannot
/// be written.
void WriteSparseKeyframes(const std::filesystem::path& folder, std::span<const Map> maps,
                          Sequence* sequence);

}  // namespace orb360
