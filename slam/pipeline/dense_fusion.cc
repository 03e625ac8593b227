#include "slam/io/dense_cloud_file.h"
#include "slam/pipeline/dense_views.h"
#include <orb360/slam/pipeline/dense_fusion.h>

namespace orb360 {

DenseCloudSummary WriteDenseCloud(const std::filesystem::path& path,
                                  const Reconstruction& reconstruction,
                                  const DepthMapStore& depth_maps, const Rigid3& target_from_world,
                                  int num_threads) {
  const std::vector<DenseView> views =
      MakeDenseViews(reconstruction, target_from_world,
                     [&](int frame_index) { return depth_maps.Contains(frame_index); });
  return WriteDenseCloud(path, depth_maps, views, CloudOptionsFor(reconstruction, num_threads));
}

}  // namespace orb360
