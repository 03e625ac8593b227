#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "apps/town/render/ray_scene.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360::town {

/// A camera's path through a scene, smooth between the given poses.
class CameraPath {
 public:
  /// Takes at least two poses with increasing times.
  explicit CameraPath(std::vector<StampedPose> knots);

  double begin() const { return knots_.front().timestamp; }  ///< seconds
  double end() const { return knots_.back().timestamp; }
  /// Returns world_from_camera at a time, clamped to the path. Positions lie on cubic Hermite
  /// curves through the knots; the velocity at a knot is that of the parabola through it and its
  /// neighbours (Catmull and Rom's for any spacing in time). Rotations are interpolated
  /// spherically.
  Rigid3 At(double time) const;

 private:
  Eigen::Vector3d Velocity(size_t knot) const;

  std::vector<StampedPose> knots_;
};

/// Reads a path, z up, in metres and seconds: TUM lines `time x y z qx qy qz qw` as in a
/// groundtruth.txt, or lines `time x y z` for a camera that stays level and looks where it goes.
/// '#' begins a comment. Throws UserError with file and line.
CameraPath ReadCameraPath(const std::filesystem::path& file);

/// Writes such a path of places: seconds with six decimals, metres with three. Throws UserError.
void WriteCameraPath(const std::vector<double>& times,
                     const std::vector<Eigen::Vector3d>& positions,
                     const std::filesystem::path& file);

/// Returns level poses that look from each place to the next one. Where the camera stands it keeps
/// its direction; before it first moves it looks where it will go.
std::vector<StampedPose> LookAhead(const std::vector<double>& times,
                                   const std::vector<Eigen::Vector3d>& positions);

/// Returns false if a surface is between two places, or at the second one.
bool IsFree(const RayScene& scene, const Vector3f& from, const Vector3f& to);

/// Checks that a path meets no surface until `end`, in seconds of its own time. It looks ahead in
/// steps so short that bends are followed however rare the frames are. Throws UserError that names
/// the time and the place of a collision.
void RequireFreePath(const RayScene& scene, const CameraPath& path, double end);

/// Returns the median distance to the surface below if it is nearly constant along the path.
std::optional<double> HeightAboveGround(const RayScene& scene,
                                        const std::vector<Rigid3>& world_from_camera);

}  // namespace orb360::town
