#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/pipeline/view_depth.h"

namespace orb360 {

/// The second pass of ComputeDepth: completes each view anew with what the first has measured in
/// the views around it, and puts the result into `store`.
///
/// - Objects that move along with the camera (FindMovingObjects) are put where they touch the
///   ground; their measured ranges are dropped. `up`, the normal of the ground in the world, is
///   needed for this.
/// - Where a view has no point, it gets those that other views measured (AddReprojectedPoints).
/// - Where no view measured the ground below a camera whose height is known
///   (ViewDepthOptions::camera_height), the network is given level ground (AddGroundPoints).
/// - Beside the edges of near surfaces (FindOccludingBoundary) the ranges are kept, but with so
///   little confidence that the cloud has none of them.
///
/// `first` has the depth of the first pass, of the views that have any. Views are handled in their
/// order. After `callbacks.progress` has returned false, the rest keeps the depth of the first
/// pass. Returns in how many views there were such objects. The result does not depend on the
/// number of threads.
int CompleteViews(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                  const LandmarkProjector& landmarks_of, const std::optional<Eigen::Vector3d>& up,
                  const ViewDepthOptions& options, const ImageStore& images,
                  DepthCompleter* completer, int num_threads, const DepthMapStore& first,
                  const DepthMapStore& store, const ViewDepthCallbacks& callbacks);

}  // namespace orb360
