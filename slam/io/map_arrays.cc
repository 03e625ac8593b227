#include "slam/io/map_arrays.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "slam/features/feature_index.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr size_t kPose = 7;
constexpr size_t kWords = 4;
constexpr double kUnit = 1e-6;  // how far from 1 the length of a unit vector may be
constexpr int kLevels = 8;

void Append(const Eigen::Vector3d& v, std::vector<double>* column) {
  column->insert(column->end(), {v.x(), v.y(), v.z()});
}

template <typename Array, typename Column>
void AppendAll(const Array& values, Column* column) {
  column->insert(column->end(), values.begin(), values.end());
}

Eigen::Vector3d Vector(const std::vector<double>& column, size_t row) {
  return Eigen::Map<const Eigen::Vector3d>(column.data() + 3 * row);
}

Descriptor Bits(const std::vector<uint64_t>& column, size_t row) {
  Descriptor bits;
  std::copy_n(column.begin() + static_cast<std::ptrdiff_t>(kWords * row), kWords, bits.begin());
  return bits;
}

Color ColorOf(const std::vector<uint8_t>& column, size_t row) {
  return {column[3 * row], column[3 * row + 1], column[3 * row + 2]};
}

void Require(bool is_right, const char* what, size_t row) {
  if (is_right) return;
  std::string reason = "holds no map: ";
  reason += what;
  throw UserError(reason + " " + std::to_string(row) + " is out of range");
}

template <typename T>
void RequireSize(const std::vector<T>& column, size_t rows, size_t width, const char* name) {
  if (column.size() == rows * width) return;
  std::string reason = "holds no map: column ";
  reason += name;
  throw UserError(reason + " has " + std::to_string(column.size()) + " numbers and should have " +
                  std::to_string(rows * width));
}

template <typename T>
bool AreFinite(std::span<const T> values) {
  return std::ranges::all_of(values, [](T v) { return std::isfinite(v); });
}

// True for zero with a positive sign. Minus zero is not kept, and a file that is read and written
// again must have the same bytes.
bool IsBlank(float value) { return std::bit_cast<uint32_t>(value) == 0; }

bool IsUnit(double norm) { return std::abs(norm - 1.0) < kUnit; }

bool IsAlignment(const Eigen::Vector3f& bearing, float sigma) {
  if (sigma == 0) return bearing.allFinite();
  return sigma > 0 && std::isfinite(sigma) && IsUnit(bearing.norm());
}

void CheckSizes(const MapArrays& a) {
  const size_t keyframes = a.frame_index.size();
  RequireSize(a.timestamp, keyframes, 1, "timestamp");
  RequireSize(a.pose, keyframes, kPose, "pose");
  RequireSize(a.features_end, keyframes, 1, "features_end");
  const size_t features = a.angle.size();
  RequireSize(a.pixel, features, 2, "pixel");
  RequireSize(a.sigma, features, 1, "sigma");
  RequireSize(a.level, features, 1, "level");
  RequireSize(a.score, features, 1, "score");
  RequireSize(a.bearing, features, 3, "bearing");
  RequireSize(a.feature_bits, features, kWords, "feature_bits");
  RequireSize(a.feature_color, features, 3, "feature_color");
  RequireSize(a.feature_landmark, features, 1, "feature_landmark");
  RequireSize(a.aligned_bearing, features, 3, "aligned_bearing");
  RequireSize(a.aligned_sigma, features, 1, "aligned_sigma");
  const size_t landmarks = a.max_range.size();
  RequireSize(a.position, landmarks, 3, "position");
  RequireSize(a.mean_direction, landmarks, 3, "mean_direction");
  RequireSize(a.landmark_bits, landmarks, kWords, "landmark_bits");
  RequireSize(a.landmark_color, landmarks, 3, "landmark_color");
  RequireSize(a.first_keyframe, landmarks, 1, "first_keyframe");
  RequireSize(a.visible, landmarks, 1, "visible");
  RequireSize(a.found, landmarks, 1, "found");
  constexpr size_t kMaxCount = std::numeric_limits<int32_t>::max();
  if (keyframes == 0) throw UserError("holds no map: it has no keyframe");
  if (std::max({keyframes, features, landmarks}) > kMaxCount) {
    throw UserError("holds more than any map");
  }
  int64_t before = 0;
  for (size_t k = 0; k < keyframes; ++k) {
    Require(a.features_end[k] >= before && a.features_end[k] <= static_cast<int64_t>(features),
            "the end of the features of keyframe", k);
    before = a.features_end[k];
  }
  if (before != static_cast<int64_t>(features)) {
    throw UserError("holds no map: features that belong to no keyframe");
  }
}

void CheckNumbers(const MapArrays& a) {
  const std::span<const double> poses(a.pose);
  for (size_t k = 0; k < a.frame_index.size(); ++k) {
    const std::span<const double> pose = poses.subspan(kPose * k, kPose);
    Require(std::isfinite(a.timestamp[k]) && AreFinite(pose) &&
                IsUnit(Eigen::Map<const Eigen::Vector4d>(pose.data() + 3).norm()),
            "pose of keyframe", k);
  }
  const auto num_landmarks = static_cast<int32_t>(a.max_range.size());
  for (size_t f = 0; f < a.angle.size(); ++f) {
    Require(std::isfinite(a.pixel[2 * f]) && std::isfinite(a.pixel[2 * f + 1]) &&
                std::isfinite(a.angle[f]) && std::isfinite(a.sigma[f]) && a.sigma[f] > 0 &&
                a.level[f] < kLevels && IsUnit(Vector(a.bearing, f).norm()) &&
                a.feature_landmark[f] >= kNoId && a.feature_landmark[f] < num_landmarks,
            "feature", f);
    const Eigen::Map<const Eigen::Vector3f> aligned(a.aligned_bearing.data() + 3 * f);
    Require(a.feature_landmark[f] == kNoId ? IsBlank(aligned.x()) && IsBlank(aligned.y()) &&
                                                 IsBlank(aligned.z()) && IsBlank(a.aligned_sigma[f])
                                           : IsAlignment(aligned, a.aligned_sigma[f]),
            "alignment of feature", f);
  }
  const auto num_keyframes = static_cast<int32_t>(a.frame_index.size());
  for (size_t l = 0; l < a.max_range.size(); ++l) {
    const double direction = Vector(a.mean_direction, l).norm();
    Require(Vector(a.position, l).allFinite() && (direction == 0 || IsUnit(direction)) &&
                std::isfinite(a.max_range[l]) && a.max_range[l] > 0 && a.first_keyframe[l] >= 0 &&
                a.first_keyframe[l] < num_keyframes && a.visible[l] >= 0 && a.found[l] >= 0,
            "landmark", l);
  }
}

std::shared_ptr<const Features> FeaturesOf(const MapArrays& a, size_t begin, size_t end) {
  auto features = std::make_shared<Features>();
  for (size_t f = begin; f < end; ++f) {
    features->keypoints.push_back(
        {{a.pixel[2 * f], a.pixel[2 * f + 1]}, a.angle[f], a.sigma[f], a.level[f], a.score[f]});
    features->bearings.push_back(Vector(a.bearing, f));
    features->descriptors.push_back(Bits(a.feature_bits, f));
    features->colors.push_back(ColorOf(a.feature_color, f));
  }
  IndexFeatures(features.get());
  return features;
}

}  // namespace

MapArrays ToArrays(const Map& map) {
  MapArrays a;
  std::vector<int32_t> keyframe_number(map.keyframe_end(), kNoId);
  std::vector<int32_t> landmark_number(map.landmark_end(), kNoId);
  const std::vector<KeyframeId> keyframes = map.KeyframeIds();
  for (size_t k = 0; k < keyframes.size(); ++k) {
    keyframe_number[keyframes[k]] = static_cast<int32_t>(k);
  }
  for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
    if (!map.HasLandmark(id)) continue;
    const Landmark& landmark = map.landmark(id);
    landmark_number[id] = static_cast<int32_t>(a.max_range.size());
    Append(landmark.position, &a.position);
    Append(landmark.mean_direction, &a.mean_direction);
    a.max_range.push_back(landmark.max_range);
    AppendAll(landmark.descriptor, &a.landmark_bits);
    AppendAll(landmark.color, &a.landmark_color);
    a.first_keyframe.push_back(keyframe_number[map.LivingKeyframe(landmark.first_keyframe)]);
    a.visible.push_back(landmark.visible);
    a.found.push_back(landmark.found);
  }
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = map.keyframe(id);
    const Features& features = *keyframe.features;
    ORB360_CHECK(features.colors.size() == features.keypoints.size(), id);
    a.frame_index.push_back(keyframe.frame_index);
    a.timestamp.push_back(keyframe.timestamp);
    Append(keyframe.world_from_camera.translation, &a.pose);
    AppendAll(keyframe.world_from_camera.rotation.coeffs(), &a.pose);
    for (int f = 0; f < features.size(); ++f) {
      const Keypoint& keypoint = features.keypoints[f];
      AppendAll(keypoint.pixel, &a.pixel);
      a.angle.push_back(keypoint.angle);
      a.sigma.push_back(keypoint.sigma);
      a.level.push_back(keypoint.level);
      a.score.push_back(keypoint.score);
      Append(features.bearings[f], &a.bearing);
      AppendAll(features.descriptors[f], &a.feature_bits);
      AppendAll(features.colors[f], &a.feature_color);
      const LandmarkId seen = keyframe.landmarks[f];
      a.feature_landmark.push_back(seen == kNoId ? kNoId : landmark_number[seen]);
      const Observation observation =
          seen == kNoId ? Observation{} : *map.landmark(seen).FindObservation(id);
      AppendAll(observation.aligned_bearing, &a.aligned_bearing);
      a.aligned_sigma.push_back(observation.aligned_sigma);
    }
    a.features_end.push_back(static_cast<int64_t>(a.angle.size()));
  }
  return a;
}

Map FromArrays(const MapArrays& a) {
  CheckSizes(a);
  CheckNumbers(a);
  Map map;
  for (size_t k = 0; k < a.frame_index.size(); ++k) {
    const auto begin = static_cast<size_t>(k == 0 ? 0 : a.features_end[k - 1]);
    const double* pose = a.pose.data() + kPose * k;
    map.AddKeyframe(a.frame_index[k], a.timestamp[k],
                    {Eigen::Quaterniond(pose + 3), Eigen::Vector3d(pose)},
                    FeaturesOf(a, begin, static_cast<size_t>(a.features_end[k])));
  }
  for (size_t l = 0; l < a.max_range.size(); ++l) {
    const LandmarkId id = map.AddLandmark(Vector(a.position, l), ColorOf(a.landmark_color, l));
    Landmark& landmark = map.landmark(id);
    landmark.mean_direction = Vector(a.mean_direction, l);
    landmark.max_range = a.max_range[l];
    landmark.descriptor = Bits(a.landmark_bits, l);
    landmark.first_keyframe = a.first_keyframe[l];
    landmark.visible = a.visible[l];
    landmark.found = a.found[l];
  }
  for (KeyframeId k = 0; k < map.keyframe_end(); ++k) {
    const auto begin = static_cast<size_t>(k == 0 ? 0 : a.features_end[k - 1]);
    for (size_t f = begin; f < static_cast<size_t>(a.features_end[k]); ++f) {
      const LandmarkId id = a.feature_landmark[f];
      if (id == kNoId) continue;
      const std::vector<Observation>& seen = map.landmark(id).observations;
      Require(seen.empty() || seen.back().keyframe != k, "landmark seen twice at feature", f);
      map.AddObservation(id, k, static_cast<int>(f - begin));
      Observation& observation = map.landmark(id).observations.back();
      observation.aligned_bearing = Eigen::Vector3f(a.aligned_bearing.data() + 3 * f);
      observation.aligned_sigma = a.aligned_sigma[f];
    }
  }
  for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
    Require(!map.landmark(id).observations.empty(), "number of sightings of landmark",
            static_cast<size_t>(id));
  }
  return map;
}

}  // namespace orb360
