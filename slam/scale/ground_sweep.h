#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// The ground that is looked at reaches this far from the point half-way between the two cameras,
/// along the motion and across it, in heights of the camera.
inline constexpr double kGroundSweepAlong = 0.96;
inline constexpr double kGroundSweepAcross = 1.6;

struct GroundSweepOptions {
  /// Least and largest ratio of the step to the camera's height that are looked at.
  double min_ratio = 0.1;
  double max_ratio = 4.4;
  /// Largest shift across the given direction of motion, heights of the camera: what its error
  /// makes of the step.
  double max_aside = 0.24;
  /// Least mean correlation of the two images of the ground.
  double min_correlation = 0.2;
  /// Largest correlation of another ratio, as a fraction of the best one's. Where the ground
  /// repeats itself, several ratios look alike.
  double max_rival = 0.8;
  /// Largest standard deviation of ln(ratio). Where the tiles scatter more, most of them are wrong.
  double max_sigma = 0.03;
  /// Least number of tiles of the ground that must agree.
  int min_tiles = 12;
  /// Distance between the lens that looks ahead and the one that looks back, heights of the camera:
  /// what stitching leaves of it near the ground. 0: all is seen from one point.
  double lens_distance = 0;
};

/// What two images of the ground tell about the camera's motion between them.
struct GroundStep {
  /// Length of the step, divided by the height of the cameras over the ground: the distance of the
  /// point half-way between them from the plane.
  double ratio = 0;
  /// Standard deviation of ln(ratio), from the scatter of the tiles. Uneven ground, which moves all
  /// tiles together, is not included.
  double sigma = 0;
  /// Direction of the motion over the ground, unit, frame of camera 1. It is more exact than the
  /// one that was given where only far points have shown that.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  /// Angle about `up` by which the given camera1_from_camera2 must be turned on, rad, and its
  /// standard deviation.
  double turn = 0;
  double turn_sigma = 0;
  /// Normal of the ground below the point half-way, unit, frame of camera 1.
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  /// What the tiles tell of the distance between the lenses, heights of the camera; sigma 0 where
  /// they tell nothing.
  LensDistance lens_distance;
  /// Change of `ratio` with the distance between the lenses that is assumed.
  double per_lens_distance = 0;
  /// Mean correlation of the tiles at the best ratio, of those straight below where only they show
  /// it.
  double correlation = 0;
  double rival = 0;   ///< Largest mean correlation at any other ratio that is a local maximum.
  int num_tiles = 0;  ///< Number of tiles that agree.
};

/// Measures how far a camera moved over flat ground between two images, relative to its height over
/// the ground (the lead of Lovegrove, Davison, Ibanez-Guzman, IV 2011). Both images are rectified
/// to the ground plane. In this bird's-eye view the step is a shift along the direction of motion,
/// so that a sweep over the shift finds it without corners or descriptors, even on asphalt.
///
/// The height of the camera is that over the ground straight below it. Where that lies higher than
/// the rest (a dam, a bridge), the tiles there tell the step. A camera that hardly moves has none.
///
/// `camera1_from_camera2` gives the approximate rotation and direction of the motion; its length is
/// not used. The ground also shows the rotation about its normal. `up` is the approximate normal of
/// the ground, unit, frame of camera 1; the ground is taken to be parallel to the motion, or where
/// that shows nothing, to have this normal. An error of the normal cancels to first order, because
/// the tiles lie symmetrically about the point half-way; where the tiles show that the normal is
/// wrong by more than that allows, the measurement is repeated with the one that they show. `mask`
/// (CV_8U, size of level 0, 0: not used; may be empty) removes what moves with the camera.
///
/// Panoramic cameras have two lenses, which look along the camera's x axis and back, and stitching
/// joins their images as if all were far away. The ground ahead is then seen from another point
/// than the ground behind, and a step by which it passes from one to the other looks too short by
/// the distance of the lenses: 3 cm make 2 to 6 % of a step. Tiles that stay on one side do not
/// show that, so that the distance can be measured.
///
/// Empty where the camera moves along the normal, and where no ratio passes the options.
std::optional<GroundStep> MeasureGroundStep(const SpherePyramid& image1,
                                            const SpherePyramid& image2,
                                            const Rigid3& camera1_from_camera2,
                                            const Eigen::Vector3d& up, const cv::Mat& mask,
                                            const GroundSweepOptions& options);

/// What a measurement may start from, frame of camera 1.
struct GroundStepGuess {
  Eigen::Vector3d direction;  ///< Of the motion; its length is not used.
  Eigen::Vector3d up;         ///< Normal of the ground, unit.
};

/// The same from the first of several guesses that gives a step, in their order. Where one finds
/// several ratios that correlate well, the ground repeats itself, and there is none: sooner or
/// later one of the others would leave the true ratio out and show another one alone.
std::optional<GroundStep> MeasureGroundStep(const SpherePyramid& image1,
                                            const SpherePyramid& image2,
                                            const Eigen::Quaterniond& camera1_from_camera2,
                                            std::span<const GroundStepGuess> guesses,
                                            const cv::Mat& mask, const GroundSweepOptions& options);

}  // namespace orb360
