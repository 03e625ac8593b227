#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// A map as plain columns, in the form of the file (docs/formats/map.md). Keyframes and landmarks
/// are numbered from 0 without gaps, in the order of their ids. Removed ones, images and patches of
/// images are not contained.
struct MapArrays {
  // One row per keyframe.
  std::vector<int32_t> frame_index;
  std::vector<double> timestamp;      // s
  std::vector<double> pose;           // world_from_camera: x y z, quaternion x y z w
  std::vector<int64_t> features_end;  // number of features up to and with this keyframe's
  // One row per feature, keyframe after keyframe.
  std::vector<float> pixel;  // u v
  std::vector<float> angle;
  std::vector<float> sigma;
  std::vector<uint8_t> level;
  std::vector<uint8_t> score;
  std::vector<double> bearing;            // x y z
  std::vector<uint64_t> feature_bits;     // 4 words
  std::vector<uint8_t> feature_color;     // red green blue
  std::vector<int32_t> feature_landmark;  // -1: none
  std::vector<float> aligned_bearing;     // x y z; of the observation of that landmark
  std::vector<float> aligned_sigma;       // 0: not aligned
  // One row per landmark.
  std::vector<double> position;        // x y z
  std::vector<double> mean_direction;  // x y z
  std::vector<double> max_range;
  std::vector<uint64_t> landmark_bits;  // 4 words
  std::vector<uint8_t> landmark_color;  // red green blue
  std::vector<int32_t> first_keyframe;
  std::vector<int32_t> visible;
  std::vector<int32_t> found;
};

/// Calls `visit(name, column, width)` for each column of a MapArrays, const or not. `name` is the
/// dataset of the file, and `width` the number of values in a row.
template <typename Arrays, typename Visit>
requires std::same_as<std::remove_const_t<Arrays>, MapArrays>
void ForEachColumn(Arrays& a, const Visit& visit) {
  visit("keyframe_frame_index", a.frame_index, 1);
  visit("keyframe_timestamp", a.timestamp, 1);
  visit("keyframe_world_from_camera", a.pose, 7);
  visit("keyframe_features_end", a.features_end, 1);
  visit("feature_pixel", a.pixel, 2);
  visit("feature_angle", a.angle, 1);
  visit("feature_sigma", a.sigma, 1);
  visit("feature_level", a.level, 1);
  visit("feature_score", a.score, 1);
  visit("feature_bearing", a.bearing, 3);
  visit("feature_descriptor", a.feature_bits, 4);
  visit("feature_color", a.feature_color, 3);
  visit("feature_landmark", a.feature_landmark, 1);
  visit("feature_aligned_bearing", a.aligned_bearing, 3);
  visit("feature_aligned_sigma", a.aligned_sigma, 1);
  visit("landmark_position", a.position, 3);
  visit("landmark_mean_direction", a.mean_direction, 3);
  visit("landmark_max_range", a.max_range, 1);
  visit("landmark_descriptor", a.landmark_bits, 4);
  visit("landmark_color", a.landmark_color, 3);
  visit("landmark_first_keyframe", a.first_keyframe, 1);
  visit("landmark_visible", a.visible, 1);
  visit("landmark_found", a.found, 1);
}

MapArrays ToArrays(const Map& map);

/// Builds the map of such columns. Throws UserError if they do not describe a map: wrong sizes,
/// numbers out of range, or a landmark that a keyframe observes twice.
Map FromArrays(const MapArrays& arrays);

}  // namespace orb360
