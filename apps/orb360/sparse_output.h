#pragma once

#include <exception>
#include <filesystem>
#include <span>

#include <orb360/slam/io/sequence.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/view_depth_report.h>

namespace orb360 {

inline constexpr const char* kSparseName = "sparse";

/// Creates `folder`/sparse and removes what an earlier run has written there. Returns it. Throws
/// UserError where that fails.
std::filesystem::path MakeSparseFolder(const std::filesystem::path& folder);

/// Returns a sink that writes what the network completes to `folder`/sparse/000123.h5, named by the
/// frame index (WriteSparseSample). The first error ends writing and becomes `failure`, unless
/// there is one already, so that it costs no depth.
SparseSampleSink SparseWriter(const std::filesystem::path& folder, std::exception_ptr* failure);

/// Writes the image of every keyframe with its sparse ranges and their confidence to
/// `folder` in the same way. `sequence` is the input of the
/// run, opened again because a run does not keep its images. Throws UserError where a file cannot
/// be written.
void WriteSparseKeyframes(const std::filesystem::path& folder, std::span<const Map> maps,
                          Sequence* sequence);

}  // namespace orb360
