#include "apps/orb360/dense_output.h"

#include <cstdio>
#include <string>
#include <system_error>

#include "slam/io/dataset.h"
#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {

DenseOutput WriteDenseOutput(const std::filesystem::path& folder, const DepthMapStore& store,
                             std::span<const DenseView> views, const DenseCloudOptions& options,
                             bool has_mesh) {
  DenseOutput output;
  if (views.empty()) {
    output.cloud = WriteDenseCloud(folder / "cloud.ply", store, views, options);
    return output;
  }
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
                                   if (mesh) try_mesh([&] { mesh->Add(points); });
                                 });
  if (mesh) try_mesh([&] { output.mesh = mesh->Write(); });
  return output;
}

void SaveDepth(const std::filesystem::path& folder, const DepthMapStore& store,
               std::span<const DenseView> views) {
  RemoveSavedDepth(folder);
  const std::filesystem::path ranges = folder / Dataset::kDepthName;
  const std::filesystem::path confidences = folder / Dataset::kConfidenceName;
  const std::filesystem::path sources = folder / Dataset::kSourceName;
  for (const std::filesystem::path& images : {ranges, confidences, sources}) {
    std::error_code error;
    std::filesystem::create_directories(images, error);
    if (error) ThrowWriteError(images, error.value());
  }
  for (const DenseView& view : views) {
    char name[32];
    std::snprintf(name, sizeof name, "%06d.png", view.frame_index);
    const DenseDepth depth = store.Get(view.frame_index);
    WriteDepthImage(ranges / name, depth.range);
    WriteFractionImage(confidences / name, depth.confidence);
    WriteSourceImage(sources / name, depth.source);
  }
}

void RemoveSavedDepth(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "summary.json")) return;
  const auto is_of_a_frame = [](const std::filesystem::path& path) {
    const std::string index = path.stem().string();
    return path.extension() == ".png" && index.find_first_not_of("0123456789") == std::string::npos;
  };
  for (const char* name : {Dataset::kDepthName, Dataset::kConfidenceName, Dataset::kSourceName}) {
    std::error_code error;
    std::vector<std::filesystem::path> images;
    for (const auto& entry : std::filesystem::directory_iterator(folder / name, error)) {
      if (is_of_a_frame(entry.path())) images.push_back(entry.path());
    }
    for (const std::filesystem::path& image : images) std::filesystem::remove(image, error);
    std::filesystem::remove(folder / name, error);  // Fails unless it is empty.
  }
}

}  // namespace orb360
