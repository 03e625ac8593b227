#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/geometry/alignment.h"
#include "tests/slam/geometry/box_room.h"
#include <orb360/slam/geometry/so3.h>
#include <orb360/slam/io/frame_source.h>
#include <orb360/slam/pipeline/options.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {

inline const EquirectangularCamera kHallCamera(640, 320);

/// A walk through a hall on a curve, the camera swaying: 25 frames a second, about 1.3 m/s.
inline Rigid3 TruePose(double frame) {
  const double t = frame / 25.0;
  const Eigen::Vector3d position(6.0 - 1.3 * t, 1.2 * std::sin(0.5 * t), 0.05 * std::sin(6.0 * t));
  const Eigen::Quaterniond yaw = ExpSo3(Eigen::Vector3d(0.0, 0.0, -0.4 * std::sin(0.5 * t)));
  return {yaw * ExpSo3({0.03 * std::sin(5.0 * t), 0.04 * std::sin(3.0 * t), 0.0}), position};
}

inline BoxRoom Hall(uint64_t seed = 1) { return BoxRoom({8.0, 4.0, 2.0}, seed); }

inline Options SmallOptions() {
  Options options;
  options.orb.num_features = 1000;
  options.scale.camera_height = 2.0;  // of TruePose over the floor of Hall
  return options;
}

inline Frame MakeFrame(int index, const cv::Mat& image) { return {index, index / 25.0, image}; }

/// Feeds `frames` and returns everything; a frame number that is not whole is still its own frame.
inline Reconstruction Track(const BoxRoom& room, const std::vector<double>& frames,
                            int num_threads = 2) {
  Options options = SmallOptions();
  options.num_threads = num_threads;
  System system(kHallCamera, options, {});
  for (size_t i = 0; i < frames.size(); ++i) {
    system.Process(MakeFrame(static_cast<int>(i), room.Render(kHallCamera, TruePose(frames[i]))));
  }
  return system.Finish();
}

inline std::vector<double> Count(int count) {
  std::vector<double> frames;
  for (int i = 0; i < count; ++i) frames.push_back(i);
  return frames;
}

/// Root mean square and length of the path, after the best similarity.
struct PathError {
  double rmse = 0;
  double length = 0;
  double worst_rotation = 0;  // rad
  double scale = 1;           // from the result to the truth
};
inline PathError Compare(const std::vector<FramePose>& frames, const std::vector<double>& truth) {
  std::vector<Eigen::Vector3d> found;
  std::vector<Eigen::Vector3d> expected;
  PathError error;
  for (const FramePose& frame : frames) {
    found.push_back(frame.world_from_camera.translation);
    expected.push_back(TruePose(truth[frame.index]).translation);
    if (expected.size() > 1) {
      error.length += (expected.back() - expected[expected.size() - 2]).norm();
    }
  }
  const Similarity3 fit = AlignSimilarity(found, expected).value();
  error.scale = fit.scale;
  double sum = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    sum += (fit * found[i] - expected[i]).squaredNorm();
    const Eigen::Quaterniond rotation = fit.rotation * frames[i].world_from_camera.rotation;
    error.worst_rotation = std::max(
        error.worst_rotation, rotation.angularDistance(TruePose(truth[frames[i].index]).rotation));
  }
  error.rmse = std::sqrt(sum / static_cast<double>(found.size()));
  return error;
}

}  // namespace orb360
