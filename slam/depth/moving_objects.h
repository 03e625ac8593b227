#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/depth/dense_ground.h"
#include "slam/depth/depth_view.h"

namespace orb360 {

struct MovingObjectOptions {
  /// A point is below the ground if its depth under the plane is more than this many heights of the
  /// camera over it plus relative_tolerance of its range.
  double tolerance = 0.25;
  double relative_tolerance = 0.03;
  /// The ray of such a point must pass through the plane nearer than this many heights of the
  /// camera. Farther away the ground may be another plane.
  double max_ground_range = 12.0;
  /// Least ratio of the ranges of an object to those of the ground in the same directions, in the
  /// median. An object that moves with less than half of the camera's speed has a smaller one; so
  /// has ground that is not even.
  double min_range_ratio = 1.85;
  /// Least solid angle of the part of an object that is below the ground, sr.
  double min_solid_angle = 5e-4;
  /// Another view sees the ground where its range is that of the plane up to these relative
  /// differences. What is a little nearer is higher ground; what is a little farther is often the
  /// wall of a pit.
  double max_relative_nearer = 0.25;
  double max_relative_farther = 0.1;
  /// How often other views must see the ground where the object hides it, for each time that they
  /// look through it at something farther away. Where the land falls away they always look through;
  /// where an object moves along, only those that have it in the same direction.
  double min_ground_ratio = 0.5;
  /// Largest height of an object, in heights of the camera.
  double max_height = 2.0;
  /// Mean relative error of an object that is put where it touches the ground
  /// (docs/results/stereo.md).
  double stated_error = 0.5;
};

/// Returns the pixels of a view whose rays pass through the ground before they reach their points,
/// CV_8U, 255 there. Such points cannot be seen.
cv::Mat FindBelowGround(const DepthView& view, const DenseGround& ground,
                        const MovingObjectOptions& options);

/// An object in an image of the whole sphere.
struct MovingObject {
  struct Column {
    int column;
    int top;          ///< First row.
    int bottom;       ///< Last row, where it touches the ground.
    double distance;  ///< Horizontal, of the ground there, in the unit of the depth.
  };
  std::vector<Column> columns;
};

/// Returns the objects in a view that move along with the camera.
///
/// At a constant velocity the images of such an object agree with a point at rest in every view. If
/// it moves the same way as the camera, that point is farther away than the object, and below the
/// ground for the lower part of it. No comparison of ranges finds this; only the ground on which
/// the object stands does. `others`, which should be far enough apart for an object to have left
/// its place, tell whether there is ground: a connected region of `below_ground` (FindBelowGround)
/// is an object if they see it. What is above the region belongs to it as long as its ranges are
/// like those of the region.
std::vector<MovingObject> FindMovingObjects(const cv::Mat& below_ground, const DepthView& view,
                                            const DenseGround& ground,
                                            std::span<const DepthView* const> others,
                                            const MovingObjectOptions& options);

/// Returns the pixels of objects, CV_8U, 255 there.
cv::Mat MaskOf(std::span<const MovingObject> objects, cv::Size size);

/// Puts objects upright where they touch the ground, with the error that is stated for them.
void PlaceOnGround(std::span<const MovingObject> objects, const DenseGround& ground,
                   const MovingObjectOptions& options, DenseDepth* depth);

}  // namespace orb360
