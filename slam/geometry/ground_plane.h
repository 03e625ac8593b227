#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace orb360 {

/// The ground as a camera at the origin sees it: normal . p = -height.
struct GroundPlane {
  Eigen::Vector3d normal;       // unit, towards the camera
  double height;                // of the camera over it, in the points' unit
  std::vector<int> points;      // indices of those that lie on it
  std::vector<double> weights;  // of those, in (0, 1]: the plane is their least squares
};

struct GroundPlaneOptions {
  /// Points less than this angle under the horizon are too far away to tell a height, rad.
  double min_below = 0.25;
  /// Largest angle between the normal and the "up" that is expected, rad.
  double max_tilt = 0.25;
  /// Points within this share of the height from the plane lie on it, or within less where most of
  /// them are nearer: kerbs and what else stands on a road would all lift it.
  double tolerance = 0.05;
  /// A ground holds so many points, and this share of all below.
  int min_points = 20;
  double min_share = 0.3;
};

/// The plane that most points below the camera lie on, by random samples (always the same ones) and
/// weighted least squares. Points are relative to the camera; `up` is a unit vector in their frame.
/// Empty where no plane holds enough of them.
std::optional<GroundPlane> FitGroundPlane(std::span<const Eigen::Vector3d> points,
                                          const Eigen::Vector3d& up,
                                          const GroundPlaneOptions& options);

}  // namespace orb360
