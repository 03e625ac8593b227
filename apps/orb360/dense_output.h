#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/io/dense_cloud_file.h"
#include "slam/io/depth_map_store.h"
#include "slam/io/mesh_file.h"
#include "slam/pipeline/dense_views.h"

namespace orb360 {

/// Name of the mesh beside a cloud.
inline constexpr const char* kMeshName = "mesh.ply";

struct DenseOutput {
  DenseCloudSummary cloud;
  std::optional<MeshSummary> mesh;
  /// Why the mesh could not be written, such as a full disk. Null where there was no failure.
  std::exception_ptr mesh_failure;
};

/// Writes cloud.ply, fused from the views, into `folder`, and the surface through its points as
/// mesh.ply where `has_mesh` is true.
DenseOutput WriteDenseOutput(const std::filesystem::path& folder, const DepthMapStore& store,
                             std::span<const DenseView> views, const DenseCloudOptions& options,
                             bool has_mesh);

/// Writes the ranges of every view, in the final unit of the world, into `folder`/depth, their
/// confidence into `folder`/confidence and their source into `folder`/source, each as a PNG
/// (slam/io/depth_image.h) that is named by the index of the frame. Images of an earlier run are
/// removed.
void SaveDepth(const std::filesystem::path& folder, const DepthMapStore& store,
               std::span<const DenseView> views);

/// Removes the images that SaveDepth wrote there in an earlier run, of which `folder` has the
/// summary. Without one they are somebody else's, and stay.
void RemoveSavedDepth(const std::filesystem::path& folder);

}  // namespace orb360
