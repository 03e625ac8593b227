#pragma once

#include <optional>
#include <vector>

#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/optimization/optimizer.h>
#include <orb360/slam/pipeline/initializer_options.h>

namespace orb360 {

/// Two views of a rigid scene. Camera 1 is the origin of the world; the unit of length is
/// arbitrary.
struct TwoViewMap {
  Rigid3 world_from_camera2;
  struct Point {
    int feature1;
    int feature2;
    Eigen::Vector3d position;
  };
  std::vector<Point> points;
};

enum class InitializationFailure {
  kFewMatches,      ///< The views have too little in common. Another reference is needed.
  kLittleParallax,  ///< The camera has not moved enough yet.
};

struct InitializationResult {
  std::optional<TwoViewMap> map;
  /// The reason where there is no map.
  InitializationFailure failure = InitializationFailure::kFewMatches;
  int num_inliers = 0;
  /// Rotation camera1_from_camera2, where there is little parallax.
  std::optional<Eigen::Quaterniond> turn;
};

/// Matches two frames, estimates their motion (five points in RANSAC), triangulates and refines by
/// bundle adjustment. The parallax of the points is measured after the rotation is removed, so that
/// a turning camera is not taken for a moving one. Runs on `num_threads` OpenMP threads; the result
/// does not depend on their number.
InitializationResult InitializeFromTwoViews(const Features& features1, const Features& features2,
                                            const InitializerOptions& options,
                                            Optimizer optimizer = Optimizer::kSchur,
                                            int num_threads = 1);

}  // namespace orb360
