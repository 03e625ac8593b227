#pragma once

#include <opencv2/core.hpp>

#include <orb360/slam/depth/sparse_depth.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// What depth completion takes of one frame.
struct SparseSample {
  cv::Mat image;             ///< CV_8UC3, BGR.
  SparseDepth sparse;        ///< Of the image's size.
  int frame_index = 0;       ///< Index in the sequence.
  double timestamp = 0;      ///< Seconds.
  Rigid3 world_from_camera;  ///< In the map's frame and unit; camera -X forward.
};

}  // namespace orb360
