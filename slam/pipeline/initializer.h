#pragma once

#include <optional>
#include <vector>

#include "slam/features/features.h"
#include "slam/geometry/rigid3.h"
#include "slam/optimization/optimizer.h"

namespace orb360 {

struct InitializerOptions {
  /// Matches within this angle first (slow motion, few mistakes), then over the whole sphere.
  double nearby_radius = 0.3;
  /// Landmarks the first map must have.
  int min_landmarks = 80;
  /// Median parallax of the matches that are not far away, which makes a baseline, radians ...
  double min_parallax = 0.026;
  /// ... and in standard deviations of a feature on pyramid level 0: with less, the direction of
  /// motion is a guess.
  double min_parallax_sigmas = 5.0;
  /// Parallax of a single landmark, radians.
  double min_landmark_parallax = 0.01;
  /// Of all matches, the fraction that must agree with the motion.
  double min_inlier_ratio = 0.5;
};

/// Two views of a rigid scene: frame 1's camera is the world's origin; unit of length arbitrary.
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
  kFewMatches,      // the views have too little in common: take another reference
  kLittleParallax,  // wait for more motion
};

struct InitializationResult {
  std::optional<TwoViewMap> map;
  InitializationFailure failure = InitializationFailure::kFewMatches;  // where there is no map
  int num_inliers = 0;
  /// camera1_from_camera2, where there is little parallax.
  std::optional<Eigen::Quaterniond> turn;
};

/// Matches two frames, estimates their motion (five points in RANSAC), triangulates and refines by
/// bundle adjustment. The points' parallax is measured after the rotation is taken out, so that a
/// turning camera is not taken for a moving one. Runs on `num_threads` OpenMP threads; the result
/// does not depend on how many.
InitializationResult InitializeFromTwoViews(const Features& features1, const Features& features2,
                                            const InitializerOptions& options,
                                            Optimizer optimizer = Optimizer::kSchur,
                                            int num_threads = 1);

}  // namespace orb360
