#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "slam/stereo/inverse_ranges.h"

namespace orb360 {

/// Rotates the spheres of two cameras so that their baseline is the polar axis of both. A scene
/// point then has the same azimuth in both, and its polar angles differ by the triangulation angle
/// (S. Li, "Binocular spherical stereo", 2008). Rows of the rectified image are azimuths, 2 pi
/// around the baseline, and columns are polar angles from 0 (along the baseline) to pi, so that
/// corresponding points lie in the same row.
///
/// Returns an orthonormal basis whose first column is the direction of `baseline`, unit; the others
/// are arbitrary and do not depend on the machine.
Eigen::Matrix3d BaselineAxes(const Eigen::Vector3d& baseline);

/// Samples an equirectangular image (CV_8U) at the pixels of a rectified one, bilinearly. `axes`:
/// BaselineAxes in the camera's frame. The result has `width` columns and 2 `width` rows.
cv::Mat RectifySphere(const cv::Mat& gray, const Eigen::Matrix3d& axes, int width);

/// The opposite: samples ranges that are known by rectified pixel at the pixels of an
/// equirectangular image of this size. An inverse range is interpolated where the four pixels
/// around see one surface, because on a plane it is nearly linear between pixels. Otherwise the
/// nearest pixel's is taken.
InverseRanges UnrectifySphere(const InverseRanges& rectified, const Eigen::Matrix3d& axes,
                              const cv::Size& size);

/// The unit vector through a pixel (column, row; continuous, centres at .5) of a rectified image of
/// this width, in the camera's frame.
Eigen::Vector3d RectifiedBearing(const Eigen::Vector2d& pixel, const Eigen::Matrix3d& axes,
                                 int width);

/// The pixel of a rectified image of this width that sees a direction, frame of the camera. The row
/// is in [0, 2 width).
Eigen::Vector2d RectifiedPixel(const Eigen::Vector3d& direction, const Eigen::Matrix3d& axes,
                               int width);

}  // namespace orb360
