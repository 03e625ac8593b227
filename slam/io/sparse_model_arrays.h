#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "slam/io/sparse_model.h"

namespace orb360 {

/// A sparse model as plain columns, in the form of the file (docs/formats/reconstruction.md).
struct SparseModelArrays {
  std::vector<int32_t> image_size;  // one row: width height
  // One row per frame.
  std::vector<int32_t> frame_index;
  std::vector<double> timestamp;  // s
  std::vector<int32_t> map;
  std::vector<uint8_t> is_keyframe;
  std::vector<double> pose;               // world_from_optical: x y z, quaternion x y z w
  std::vector<int64_t> observations_end;  // number of observations up to and with this frame's
  // One row per observation, frame after frame.
  std::vector<float> pixel;  // u v
  std::vector<int32_t> observed_point;
  // One row per point.
  std::vector<double> position;  // x y z
  std::vector<uint8_t> color;    // red green blue
};

/// Calls `visit(name, column, width)` for each column of a SparseModelArrays, const or not. `name`
/// is the dataset of the file, and `width` the number of values in a row.
template <typename Arrays, typename Visit>
requires std::same_as<std::remove_const_t<Arrays>, SparseModelArrays>
void ForEachColumn(Arrays& a, const Visit& visit) {
  visit("image_size", a.image_size, 2);
  visit("frame_index", a.frame_index, 1);
  visit("frame_timestamp", a.timestamp, 1);
  visit("frame_map", a.map, 1);
  visit("frame_is_keyframe", a.is_keyframe, 1);
  visit("frame_world_from_camera", a.pose, 7);
  visit("frame_observations_end", a.observations_end, 1);
  visit("observation_pixel", a.pixel, 2);
  visit("observation_point", a.observed_point, 1);
  visit("point_position", a.position, 3);
  visit("point_color", a.color, 3);
}

SparseModelArrays ToArrays(const SparseModel& model);

/// Builds the model of such columns. Throws UserError if they do not describe one: wrong sizes,
/// numbers out of range, or a point that a frame observes twice.
SparseModel ModelFromArrays(const SparseModelArrays& arrays);

}  // namespace orb360
