#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A few points of a depth map.
struct ThinnedView {
  struct Point {
    Eigen::Vector3f position;  ///< In the camera frame of the view.
    Color color{};
  };
  int frame = 0;  ///< Index in the input.
  Rigid3 world_from_camera;
  std::vector<Point> points;
};

/// Returns at most `max_points` points of a depth map, evenly spread over the sphere, and so is any
/// first part of them. Pixels without a range, and those that count with an error above a
/// tenth of it (FusionConfidence), such as those of the sky and of objects that move, give none.
std::vector<ThinnedView::Point> ThinView(const DenseDepth& depth, int max_points);

/// The dense cloud of a run while it is computed, view by view, for the pages of LiveFeed. It is
/// used by several threads.
class LiveCloud {
 public:
  /// `max_points`: of all views. Where they would have more, each view has half as many as before.
  explicit LiveCloud(size_t max_points = 2'000'000) : max_points_(max_points) {}

  void Add(int frame, const Rigid3& world_from_camera, const DenseDepth& depth);
  /// Number of views so far.
  size_t num_views() const;
  /// The page's `live.cloud`, little endian: number of views that a page has after this part, and
  /// of points of a view at most (uint32), beyond which a page drops those that it has; then for
  /// each view after the first `since` ones, 16 of them at most, the index of its frame (int32), x
  /// y z qx qy qz qw of its optical camera frame in the world (float32), its number of points
  /// (uint32), and the points as in `live.points`.
  std::string Bytes(std::uint64_t since) const;

 private:
  const size_t max_points_;
  mutable std::mutex mutex_;
  // Guarded by the mutex:
  std::vector<std::shared_ptr<const ThinnedView>> views_;
  size_t num_points_ = 0;
  size_t max_of_view_ = 5000;
};

}  // namespace orb360
