#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include <orb360/slam/depth/sparse_depth.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// The data of one keyframe that depth completion needs.
struct SparseSample {
  cv::Mat image;  // CV_8UC3, BGR
  SparseDepth sparse;
  int frame_index = 0;
  double timestamp = 0;      // s
  Rigid3 world_from_camera;  // map frame and units, camera -X forward
};

/// Writes one HDF5 file (docs/formats/sparse_depth.md): datasets `image` (height x width x 3,
/// uint8, RGB), `range` and `confidence` (height x width, float32, 0 = no point; range along the
/// ray in the map's units), and attributes `frame_index`, `timestamp` and `world_from_camera` (tx
/// ty tz qx qy qz qw). Throws UserError if the file cannot be written; no partial file remains.
void WriteSparseSample(const std::filesystem::path& path, const SparseSample& sample);

/// Reads such a file. Throws UserError for a file that is missing or has another form.
SparseSample ReadSparseSample(const std::filesystem::path& path);

}  // namespace orb360
