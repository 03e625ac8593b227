#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/geometry/bearing.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Triangulates the point that several cameras see along unit bearings (paper Eq. 8-9), in the
/// world frame.
///
/// Each view requires bearing x (camera_from_world * X) = 0. On the bearing's tangent plane these
/// are two independent equations, linear in X and equally good for every direction. They are solved
/// by least squares and reweighted by 1/range, so that the angle is minimized and not the distance
/// to the ray. (The paper solves the homogeneous system by SVD. Here the point's fourth coordinate
/// is 1, which excludes only points at infinity and keeps more digits of far ones.)
///
/// Returns nullopt when fewer than two views are given, the rays are parallel within 1e-7 rad, or
/// the point's range is not positive in every view. Points in any direction are valid; the range is
/// measured along the bearing. Throws ContractError unless the spans are equally long.
std::optional<Eigen::Vector3d> Triangulate(std::span<const Rigid3> camera_from_world,
                                           std::span<const Eigen::Vector3d> bearings);

/// Triangulates the point that two cameras see along unit bearings, in the frame of camera 1, in
/// closed form.
///
/// The result is optimal in angle. Of all planes through the baseline it takes the one closest to
/// both bearings (least sin^2 of the angles, each divided by its sigma^2), projects both into it
/// and intersects them. This is the L2 solution of Lee and Civera, Closed-Form Optimal Two-View
/// Triangulation Based on Angular Errors (ICCV 2019), as a 2x2 eigenvalue problem.
///
/// `sigma1` and `sigma2` are the bearings' angular noise; only their ratio matters. Returns nullopt
/// when there is no baseline, the rays are parallel within 1e-7 rad, or a range is not positive.
std::optional<Eigen::Vector3d> TriangulateTwoViews(const Rigid3& camera1_from_camera2,
                                                   const Eigen::Vector3d& bearing1,
                                                   const Eigen::Vector3d& bearing2,
                                                   double sigma1 = 1.0, double sigma2 = 1.0);

/// Returns the cosine of the angle at which the rays of a match (unit bearings, each in its
/// camera's frame) meet: 1 for a point at infinity.
inline double ParallaxCosine(const Eigen::Quaterniond& camera1_from_camera2,
                             const Eigen::Vector3d& bearing1, const Eigen::Vector3d& bearing2) {
  return bearing1.dot(camera1_from_camera2 * bearing2);
}

/// Returns the angle in radians at which a point sees two camera centres; all in one frame.
inline double ParallaxAngle(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                            const Eigen::Vector3d& center2) {
  return AngleBetween(center1 - point, center2 - point);
}

/// Returns true if the point lies on the bearing's side of the camera, in any hemisphere.
inline bool HasPositiveRange(const Rigid3& camera_from_world, const Eigen::Vector3d& point,
                             const Eigen::Vector3d& bearing) {
  return bearing.dot(camera_from_world * point) > 0.0;
}

/// Returns the angular reprojection error in radians (paper Eq. 10): the angle between a bearing
/// and the direction in which the camera should see the point. The range is positive when it is
/// below pi/2.
inline double ReprojectionAngle(const Rigid3& camera_from_world, const Eigen::Vector3d& point,
                                const Eigen::Vector3d& bearing) {
  return AngleBetween(camera_from_world * point, bearing);
}

}  // namespace orb360
