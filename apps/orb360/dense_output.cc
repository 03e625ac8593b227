#include "apps/orb360/dense_output.h"

#include <algorithm>
#include <cstdio>
#include <system_error>

#include "slam/evaluation/cloud_image.h"
#include "slam/evaluation/depth_visualization.h"
#include "slam/io/dataset.h"
#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

constexpr int kCloudImageSide = 1600;   // pixels
constexpr int kDepthImageWidth = 1024;  // pixels
/// Number of views that are drawn. They are spread over the run.
constexpr size_t kDrawnViews = 3;
/// Ranges that are drawn in the colours of near and far, as multiples of the median range.
constexpr double kNear = 0.25;
constexpr double kFar = 8.0;

std::vector<DenseImages::OfView> DrawViews(const DepthMapStore& store,
                                           std::span<const DenseView> views) {
  std::vector<DenseImages::OfView> images;
  const size_t count = std::min(kDrawnViews, views.size());
  for (size_t i = 0; i < count; ++i) {
    const int frame_index = views[(2 * i + 1) * views.size() / (2 * count)].frame_index;
    const DenseDepth depth = store.Get(frame_index);
    const double median = MedianRange(depth.range);
    if (!(median > 0)) continue;
    images.push_back(
        {frame_index, DrawDepth(depth, kNear * median, kFar * median, kDepthImageWidth)});
  }
  return images;
}

}  // namespace

DenseOutput WriteDenseOutput(const std::filesystem::path& folder, const DepthMapStore& store,
                             std::span<const DenseView> views, const DenseCloudOptions& options,
                             bool has_mesh) {
  DenseOutput output;
  if (views.empty()) {
    output.cloud = WriteDenseCloud(folder / "cloud.ply", store, views, options);
    return output;
  }
  std::vector<Eigen::Vector3d> path;
  for (const DenseView& view : views) path.push_back(view.world_from_camera.translation);
  CloudImage image(path, kCloudImageSide);
  DenseCloudOptions fusion = options;
  if (!fusion.voxel_size) {
    fusion.voxel_size =
        ChooseVoxelSize(views, [&store](int frame_index) { return store.Get(frame_index); });
  }
  std::optional<MeshWriter> mesh;
  // The cloud is written even where the disk has no room for the mesh.
  const auto try_mesh = [&](const auto& step) {
    try {
      step();
    } catch (const UserError&) {
      output.mesh_failure = std::current_exception();
      mesh.reset();
    }
  };
  if (has_mesh) {
    try_mesh([&] {
      mesh.emplace(folder / kMeshName, *fusion.voxel_size, SurfaceNetsOptions(),
                   fusion.num_threads);
    });
  }
  output.cloud = WriteDenseCloud(folder / "cloud.ply", store, views, fusion,
                                 [&](std::span<const SurfacePoint> points) {
                                   image.Add(points);
                                   if (mesh) try_mesh([&] { mesh->Add(points); });
                                 });
  if (mesh) try_mesh([&] { output.mesh = mesh->Write(); });
  output.images = {image.Draw(/*is_metric=*/options.voxel_size.has_value()),
                   DrawViews(store, views)};
  return output;
}

void SaveDepth(const std::filesystem::path& folder, const DepthMapStore& store,
               std::span<const DenseView> views) {
  const std::filesystem::path images = folder / Dataset::kDepthName;
  std::error_code error;
  std::filesystem::create_directories(images, error);
  if (error) ThrowWriteError(images, error.value());
  for (const DenseView& view : views) {
    char name[32];
    std::snprintf(name, sizeof name, "%06d.png", view.frame_index);
    WriteDepthImage(images / name, store.Get(view.frame_index).range);
  }
}

}  // namespace orb360
