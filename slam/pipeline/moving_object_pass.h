#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/dense_ground.h"
#include "slam/depth/moving_objects.h"
#include "slam/io/depth_map_store.h"
#include "slam/pipeline/view_depth.h"

namespace orb360 {

struct MovingObjectPassOptions {
  /// Distances of the views that tell whether there is ground where an object is, in heights of the
  /// camera, on each side of the path, and the largest ratio between that distance and the one
  /// wanted. A car has left its place on the way.
  std::vector<double> distances = {3, 4.5, 6.5, 9};
  double max_distance_ratio = 1.4;
  MovingObjectOptions objects = {};
  DenseGroundOptions ground = {};
};

/// Corrects the ranges of objects that move along with the camera in the depth of all views that
/// have some (PlaceMovingObjects), and returns in how many views there was one. `up` is the normal
/// of the ground in the world. A view in which no ground is found stays as it is. Views are handled
/// in their order, and each one is compared with the corrected depth of those before it. Ends early
/// when `progress` returns false.
int CorrectMovingObjects(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                         const Eigen::Vector3d& up, const MovingObjectPassOptions& options,
                         const DepthMapStore& store, const ViewProgress& progress = {});

}  // namespace orb360
