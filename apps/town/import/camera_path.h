#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "apps/town/render/ray_scene.h"
#include "slam/io/trajectory.h"

namespace orb360::town {

/// A camera's way through a scene, smooth between the poses it is given by.
class CameraPath {
 public:
  /// Poses with increasing times, at least two.
  explicit CameraPath(std::vector<StampedPose> knots);

  double begin() const { return knots_.front().timestamp; }  ///< seconds
  double end() const { return knots_.back().timestamp; }
  /// world_from_camera at a time, clamped to the path: positions on cubics through the knots
  /// (Hermite; the velocity at a knot is that of the parabola through it and its neighbours, so
  /// Catmull and Rom's for any spacing in time), rotations by spherical interpolation.
  Rigid3 At(double time) const;

 private:
  Eigen::Vector3d Velocity(size_t knot) const;

  std::vector<StampedPose> knots_;
};

/// Reads a path, z up, in metres and seconds: TUM lines `time x y z qx qy qz qw` as in a
/// groundtruth.txt, or lines `time x y z` for a camera that stays level and looks where it goes.
/// '#' begins a comment. Throws UserError with file and line.
CameraPath ReadCameraPath(const std::filesystem::path& file);

/// Level poses that look along the way from each place to the next; where the camera stands, where
/// it looked before, and before it first moves, where it goes then.
std::vector<StampedPose> LookAhead(const std::vector<double>& times,
                                   const std::vector<Eigen::Vector3d>& positions);

/// Makes sure that a path meets no surface until `end`, in seconds of its own time, looking ahead
/// in steps so short that bends are followed however rare the frames are. Throws UserError that
/// names the time and the place where it does.
void RequireFreePath(const RayScene& scene, const CameraPath& path, double end);

/// Median distance to the surface below, if it is nearly the same all along.
std::optional<double> HeightAboveGround(const RayScene& scene,
                                        const std::vector<Rigid3>& world_from_camera);

}  // namespace orb360::town
