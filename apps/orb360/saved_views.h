#pragma once

#include <filesystem>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/io/depth_map_store.h"
#include "slam/io/sparse_model.h"

namespace orb360 {

/// Name of the folder in that of a run.
inline constexpr const char* kViewsName = "views";

/// The views of a dense cloud, ordered by frame.
struct SavedViews {
  bool is_metric = false;  ///< Whether the unit of length is the metre.
  std::vector<DenseView> views;
};

/// Copies the depth maps of the views to a folder, which is made anew, and writes the views beside
/// them (docs/formats/views.md). Throws UserError where the disk fails or a depth map is damaged.
void SaveViews(const std::filesystem::path& folder, const DepthMapStore& store,
               const SavedViews& saved);

/// Reads the views of a folder, whose depth maps DepthMapStore::Open reads. Throws UserError if
/// they are missing or damaged.
SavedViews LoadViews(const std::filesystem::path& folder);

/// Returns the frames of a model whose views are in a folder, ascending. An earlier run in the same
/// place may have left views for other poses, which are not those of this run. Throws as LoadViews.
std::vector<int> FramesWithDepth(const std::filesystem::path& folder, const SparseModel& model);

}  // namespace orb360
