#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace orb360 {

/// The ground as seen from a camera at the origin: normal . p = -height.
struct GroundPlane {
  Eigen::Vector3d normal;       // unit, towards the camera
  double height;                // of the camera over it, in the points' unit
  std::vector<int> points;      // indices of those that lie on it
  std::vector<double> weights;  // of those, in (0, 1]: the plane is their least squares
};

struct GroundPlaneOptions {
  /// Points less than this angle below the horizon are too far away to determine a height, rad.
  double min_below = 0.25;
  /// Largest angle between the normal and the expected "up", rad.
  double max_tilt = 0.25;
  /// Points within this fraction of the height from the plane lie on it. The tolerance is smaller
  /// where most points are nearer, because kerbs and objects standing on a road would lift the
  /// plane.
  double tolerance = 0.05;
  /// A ground must contain this many points and the fraction below of all points under the camera.
  int min_points = 20;
  double min_fraction = 0.3;
};

/// Fits the plane that contains most points below the camera, by random samples with a fixed seed
/// and weighted least squares. Points are relative to the camera; `up` is a unit vector in their
/// frame. Returns nullopt where no plane contains enough points.
std::optional<GroundPlane> FitGroundPlane(std::span<const Eigen::Vector3d> points,
                                          const Eigen::Vector3d& up,
                                          const GroundPlaneOptions& options);

}  // namespace orb360
