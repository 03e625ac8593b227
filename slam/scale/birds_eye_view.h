#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// The ground as one camera sees it, in cells: rows along the direction of motion, columns across
/// it. After NormalizeLocally the gray values are relative to the
/// mean around them and divided by their standard deviation, so that a mean product of two views is
/// their normalized correlation; 0 where the ground is masked.
struct BirdsEyeView {
  int begin;  // first row, relative to the point below the camera, and the end
  int end;
  int half_width;             // columns on each side of that point
  std::vector<float> values;  // row by row

  int width() const { return 2 * half_width; }
  const float* At(int along, int across) const {
    return &values[static_cast<size_t>(along - begin) * width() + across + half_width];
  }
};

/// Gray values of the ground. `axes`: columns are the direction of motion, left and up, in the
/// camera's frame. `mask`: see MeasureGroundStep. `cell`: side of a cell, heights of the camera.
BirdsEyeView LookDown(const SpherePyramid& image, const Eigen::Matrix3d& axes, const cv::Mat& mask,
                      double cell, int begin, int end, int half_width);

/// Joins `count` x `count` cells of gray values; masked where one of them is. Contract: `count`
/// divides the numbers of the view.
BirdsEyeView JoinCells(int count, const BirdsEyeView& fine);

/// Replaces gray values by those relative to the mean and the deviation within `radius` cells.
void NormalizeLocally(int radius, BirdsEyeView* view);

}  // namespace orb360
