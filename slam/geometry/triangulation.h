#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/geometry/bearing.h"
#include "slam/geometry/rigid3.h"

namespace orb360 {

/// The point that several cameras see along unit bearings (paper Eq. 8-9), in the world frame.
///
/// Each view says bearing x (camera_from_world * X) = 0; on the bearing's tangent plane that is two
/// independent equations, linear in X and equally good for every direction. They are solved by
/// least squares and weighted anew by 1/range, so that what is minimized is the angle and not the
/// distance to the ray. (The paper solves the homogeneous system by SVD; the point's fourth
/// coordinate is set to 1 here, which loses only points at infinity and keeps more digits of far
/// ones.)
///
/// Empty when fewer than two views are given, the rays are parallel within 1e-7 rad, or the
/// point's range is not positive in every view. Points behind a camera are as good as any: the
/// range is measured along the bearing. Throws ContractError unless the spans are equally long.
std::optional<Eigen::Vector3d> Triangulate(std::span<const Rigid3> camera_from_world,
                                           std::span<const Eigen::Vector3d> bearings);

/// The point that two cameras see along unit bearings, in the frame of camera 1, in closed form.
///
/// Optimal in angle: of all planes through the baseline it takes the one closest to both bearings
/// (least sin^2 of the angles, each divided by its sigma^2), projects both into it and intersects.
/// That is the L2 solution of Lee and Civera, Closed-Form Optimal Two-View Triangulation Based on
/// Angular Errors (ICCV 2019), as a 2x2 eigenvalue problem.
///
/// `sigma1` and `sigma2` are the bearings' angular noise; only their ratio matters. Empty when
/// there is no baseline, the rays are parallel within 1e-7 rad, or a range is not positive.
std::optional<Eigen::Vector3d> TriangulateTwoViews(const Rigid3& camera1_from_camera2,
                                                   const Eigen::Vector3d& bearing1,
                                                   const Eigen::Vector3d& bearing2,
                                                   double sigma1 = 1.0, double sigma2 = 1.0);

/// Cosine of the angle at which the rays of a match (unit bearings, each in its camera's frame)
/// meet: 1 for a point at infinity.
inline double ParallaxCosine(const Eigen::Quaterniond& camera1_from_camera2,
                             const Eigen::Vector3d& bearing1, const Eigen::Vector3d& bearing2) {
  return bearing1.dot(camera1_from_camera2 * bearing2);
}

/// Angle in radians at which a point sees two camera centres; all in one frame.
inline double ParallaxAngle(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                            const Eigen::Vector3d& center2) {
  return AngleBetween(center1 - point, center2 - point);
}

/// Whether the point lies on the bearing's side of the camera, in any hemisphere.
inline bool HasPositiveRange(const Rigid3& camera_from_world, const Eigen::Vector3d& point,
                             const Eigen::Vector3d& bearing) {
  return bearing.dot(camera_from_world * point) > 0.0;
}

/// Angular reprojection error in radians (paper Eq. 10): between a bearing and the direction in
/// which the camera should see the point. Below pi/2 the range is positive.
inline double ReprojectionAngle(const Rigid3& camera_from_world, const Eigen::Vector3d& point,
                                const Eigen::Vector3d& bearing) {
  return AngleBetween(camera_from_world * point, bearing);
}

}  // namespace orb360
