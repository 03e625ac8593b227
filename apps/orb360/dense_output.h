#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "apps/orb360/run_report.h"
#include "slam/depth/dense_cloud.h"
#include "slam/io/dense_cloud_file.h"
#include "slam/io/depth_map_store.h"
#include "slam/pipeline/dense_views.h"

namespace orb360 {

struct DenseOutput {
  DenseCloudSummary cloud;
  DenseImages images;
};

/// Writes cloud.ply, fused from the views, into `folder`, and draws it and a few keyframes.
DenseOutput WriteDenseOutput(const std::filesystem::path& folder, const DepthMapStore& store,
                             std::span<const DenseView> views, const DenseCloudOptions& options);

/// Writes the range of every view into `folder`/depth, a 16-bit PNG (WriteDepthImage) named by the
/// frame's index, in the world's unit at the end.
void SaveDepth(const std::filesystem::path& folder, const DepthMapStore& store,
               std::span<const DenseView> views);

}  // namespace orb360
