#include "slam/io/sparse_model_arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr size_t kPose = 7;
constexpr double kUnit = 1e-6;  // how far from 1 the length of a quaternion may be
/// Largest width and height. Formats of images have 16 bits for them.
constexpr int kMaxSide = 65535;  // pixels

void Require(bool is_right, const char* what) {
  if (is_right) return;
  std::string reason = "holds no reconstruction: ";
  throw UserError(reason += what);
}

void RequireRow(bool is_right, const char* what, size_t row) {
  if (is_right) return;
  std::string reason = "holds no reconstruction: ";
  reason += what;
  throw UserError(reason + " " + std::to_string(row) + " is out of range");
}

void CheckSizes(const SparseModelArrays& a) {
  Require(a.image_size.size() == 2 &&
              std::ranges::all_of(a.image_size,
                                  [](int32_t side) { return side > 0 && side <= kMaxSide; }),
          "its size of images is out of range");
  const size_t frames = a.frame_index.size();
  const size_t observations = a.observed_point.size();
  const size_t points = a.color.size() / 3;
  Require(a.timestamp.size() == frames && a.map.size() == frames &&
              a.is_keyframe.size() == frames && a.pose.size() == kPose * frames &&
              a.observations_end.size() == frames,
          "its columns of frames differ in length");
  Require(a.pixel.size() == 2 * observations, "its columns of observations differ in length");
  Require(a.color.size() == 3 * points && a.position.size() == 3 * points,
          "its columns of points differ in length");
  constexpr size_t kMaxCount = std::numeric_limits<int32_t>::max();
  Require(std::max({frames, observations, points}) <= kMaxCount, "it is larger than any");
  int64_t before = 0;
  for (size_t f = 0; f < frames; ++f) {
    RequireRow(a.observations_end[f] >= before &&
                   a.observations_end[f] <= static_cast<int64_t>(observations),
               "the end of the observations of frame", f);
    RequireRow(a.is_keyframe[f] != 0 || a.observations_end[f] == before,
               "the number of observations of frame", f);
    before = a.observations_end[f];
  }
  Require(before == static_cast<int64_t>(observations), "observations that belong to no frame");
}

void CheckFrames(const SparseModelArrays& a) {
  for (size_t f = 0; f < a.frame_index.size(); ++f) {
    const int before = f == 0 ? -1 : a.frame_index[f - 1];
    RequireRow(a.frame_index[f] > before, "the index of frame", f);
    RequireRow(a.map[f] >= 0 && a.is_keyframe[f] <= 1, "the map of frame", f);
    const double* pose = a.pose.data() + kPose * f;
    RequireRow(std::isfinite(a.timestamp[f]) &&
                   Eigen::Map<const Eigen::Vector3d>(pose).allFinite() &&
                   std::abs(Eigen::Map<const Eigen::Vector4d>(pose + 3).norm() - 1.0) < kUnit,
               "the pose of frame", f);
  }
}

void CheckObservations(const SparseModelArrays& a) {
  const auto points = static_cast<int32_t>(a.color.size() / 3);
  std::vector<int64_t> last_frame(a.color.size() / 3, -1);  // that observes a point
  size_t o = 0;
  for (size_t f = 0; f < a.frame_index.size(); ++f) {
    for (; o < static_cast<size_t>(a.observations_end[f]); ++o) {
      const float u = a.pixel[2 * o];
      const float v = a.pixel[2 * o + 1];
      const int32_t point = a.observed_point[o];
      RequireRow(u >= 0 && u <= static_cast<float>(a.image_size[0]) && v >= 0 &&
                     v <= static_cast<float>(a.image_size[1]) && point >= 0 && point < points,
                 "observation", o);
      int64_t& last = last_frame[static_cast<size_t>(point)];
      RequireRow(last != static_cast<int64_t>(f),
                 "the point, which its frame observes twice, of observation", o);
      last = static_cast<int64_t>(f);
    }
  }
  for (size_t p = 0; p < last_frame.size(); ++p) {
    RequireRow(Eigen::Map<const Eigen::Vector3d>(a.position.data() + 3 * p).allFinite(), "point",
               p);
  }
}

}  // namespace

SparseModelArrays ToArrays(const SparseModel& model) {
  SparseModelArrays a;
  a.image_size = {model.width, model.height};
  for (const PosedFrame& frame : model.frames) {
    a.frame_index.push_back(frame.index);
    a.timestamp.push_back(frame.timestamp);
    a.map.push_back(frame.map);
    a.is_keyframe.push_back(frame.is_keyframe ? 1 : 0);
    const Rigid3& pose = frame.world_from_optical;
    a.pose.insert(a.pose.end(), pose.translation.begin(), pose.translation.end());
    a.pose.insert(a.pose.end(), pose.rotation.coeffs().begin(), pose.rotation.coeffs().end());
    for (const PointObservation& observation : frame.observations) {
      a.pixel.insert(a.pixel.end(), {observation.pixel.x(), observation.pixel.y()});
      a.observed_point.push_back(observation.point);
    }
    a.observations_end.push_back(static_cast<int64_t>(a.observed_point.size()));
  }
  for (const ColoredLandmark& point : model.points) {
    a.position.insert(a.position.end(), point.position.begin(), point.position.end());
    a.color.insert(a.color.end(), point.color.begin(), point.color.end());
  }
  return a;
}

SparseModel ModelFromArrays(const SparseModelArrays& a) {
  CheckSizes(a);
  CheckFrames(a);
  CheckObservations(a);
  SparseModel model{a.image_size[0], a.image_size[1], {}, {}};
  model.frames.reserve(a.frame_index.size());
  size_t o = 0;
  for (size_t f = 0; f < a.frame_index.size(); ++f) {
    const double* pose = a.pose.data() + kPose * f;
    PosedFrame& frame =
        model.frames.emplace_back(PosedFrame{a.frame_index[f],
                                             a.timestamp[f],
                                             a.map[f],
                                             a.is_keyframe[f] != 0,
                                             {Eigen::Quaterniond(pose + 3), Eigen::Vector3d(pose)},
                                             {}});
    frame.observations.reserve(static_cast<size_t>(a.observations_end[f]) - o);
    for (; o < static_cast<size_t>(a.observations_end[f]); ++o) {
      frame.observations.push_back({{a.pixel[2 * o], a.pixel[2 * o + 1]}, a.observed_point[o]});
    }
  }
  model.points.reserve(a.color.size() / 3);
  for (size_t p = 0; p < a.color.size() / 3; ++p) {
    model.points.push_back({Eigen::Vector3d(a.position.data() + 3 * p),
                            {a.color[3 * p], a.color[3 * p + 1], a.color[3 * p + 2]}});
  }
  return model;
}

}  // namespace orb360
