#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "slam/depth/depth_view.h"
#include <orb360/slam/depth/sparse_depth.h>

namespace orb360 {

struct ReprojectionOptions {
  /// Side of the squares that get at most one point, pixels.
  int spacing = 6;
  /// Distance of the pixels of another view that are looked at, in both directions, pixels: less
  /// than `spacing`, so that a square seldom gets none.
  int step = 4;
  /// Largest expected error of ln(range) of a pixel that is taken: that of measured ones after
  /// their confidence has been rounded to 1/255, and less than that of completed ones.
  double max_error = 0.0625;
  /// Two ranges in a square agree if their ratio is at most this. Two views must agree.
  double max_ratio = 1.1;
  /// A point farther away than the nearest one that is known within two squares, by more than this
  /// ratio, is taken to be hidden.
  double max_hidden_ratio = 1.5;
  /// Largest difference of the logarithms of a surface's colour in two views, of any channel, after
  /// that of their exposures. A larger one: this view sees something else there, which hides it.
  double max_color_difference = 0.5;
  /// The confidence of a point follows from its error as that of a landmark.
  SparseDepthOptions sparse = {};
};

/// Returns the colours of surfaces around each pixel, CV_8UC3: those of a panorama (CV_8UC3),
/// resampled to `size` and blurred, so that views at different distances can be compared.
cv::Mat SurfaceColors(const cv::Mat& image, cv::Size size);

/// What another view sees.
struct SeenView {
  const DepthView* depth;
  const cv::Mat* colors;  ///< SurfaceColors, of the size of the depth.
};

/// Adds points that other views measured to the sparse depth of a view at `world_from_camera`: in
/// each square without a point the nearest range on which two of them agree, where this view shows
/// the same colours. `colors`: its SurfaceColors, of the size of `sparse`.
/// Contract: the types and sizes of colours.
void AddReprojectedPoints(const Rigid3& world_from_camera, const cv::Mat& colors,
                          std::span<const SeenView> others, const ReprojectionOptions& options,
                          SparseDepth* sparse, int num_threads = 1);

}  // namespace orb360
