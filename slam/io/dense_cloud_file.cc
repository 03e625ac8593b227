#include "slam/io/dense_cloud_file.h"

#include <vector>

#include "slam/io/ply.h"
#include "slam/io/voxel_tiles.h"

namespace orb360 {

DenseCloudSummary WriteDenseCloud(const std::filesystem::path& path, const DepthMapStore& store,
                                  std::span<const DenseView> views,
                                  const DenseCloudOptions& options,
                                  const std::function<void(std::span<const SurfacePoint>)>& look) {
  std::filesystem::path folder = path;
  folder += ".voxels";
  VoxelTiles tiles(folder);
  DenseCloudSummary summary;
  summary.fusion = FuseCloud(
      views, [&store](int frame_index) { return store.Get(frame_index); }, options,
      [&tiles](std::span<const Voxel> voxels) { tiles.Append(voxels); });
  SurfacePlyWriter writer(path, summary.fusion.voxel_size);
  std::vector<SurfacePoint> points;
  tiles.ForEach([&](std::span<const Voxel> voxels) {
    points.clear();
    for (const Voxel& voxel : voxels) {
      points.push_back(
          MakeSurfacePoint(voxel, summary.fusion.voxel_size, options.consistency.max_independent));
    }
    writer.Append(points);
    if (look) look(points);
  });
  writer.Commit();
  summary.points = writer.num_points();
  return summary;
}

}  // namespace orb360
