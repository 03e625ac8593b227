#include "slam/pipeline/make_sparse_model.h"

#include <map>
#include <utility>
#include <vector>

#include "slam/io/optical_frame.h"

namespace orb360 {
namespace {

Eigen::Vector2f PixelOf(const Keyframe& keyframe, const Observation& observation,
                        const EquirectangularCamera& camera) {
  if (observation.aligned_sigma > 0) {
    return camera.Project(observation.aligned_bearing.cast<double>()).cast<float>();
  }
  const Eigen::Vector2d pixel =
      keyframe.features->keypoints[observation.feature].pixel.cast<double>();
  return Eigen::Vector2d(camera.WrapU(pixel.x()), pixel.y()).cast<float>();
}

}  // namespace

SparseModel MakeSparseModel(const Reconstruction& reconstruction, std::span<const Map> maps,
                            const EquirectangularCamera& camera,
                            const Rigid3& file_world_from_map) {
  SparseModel model{camera.width(), camera.height(), {}, {}};
  std::map<int, PosedFrame> frames;  // by index
  const auto add_frame = [&](const FramePose& frame, bool is_keyframe) {
    if (frame.index < 0) return;
    frames.insert({frame.index,
                   {frame.index,
                    frame.timestamp,
                    frame.map,
                    is_keyframe,
                    WorldFromOptical(file_world_from_map * frame.world_from_camera),
                    {}}});
  };
  for (const FramePose& keyframe : reconstruction.keyframes) add_frame(keyframe, true);
  for (const FramePose& frame : reconstruction.frames) add_frame(frame, false);
  for (size_t m = 0; m < maps.size(); ++m) {
    const Map& map = maps[m];
    // A frame is a keyframe of one map only, the one of its entry.
    const auto frame_of = [&](KeyframeId id) -> PosedFrame* {
      const auto found = frames.find(map.keyframe(id).frame_index);
      const bool is_found = found != frames.end() && found->second.map == static_cast<int>(m);
      return is_found ? &found->second : nullptr;
    };
    for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
      if (!map.HasLandmark(id)) continue;
      const Landmark& landmark = map.landmark(id);
      const auto number = static_cast<int32_t>(model.points.size());
      bool is_observed = false;
      for (const Observation& observation : landmark.observations) {
        PosedFrame* frame = frame_of(observation.keyframe);
        if (frame == nullptr) continue;
        is_observed = true;
        frame->observations.push_back(
            {PixelOf(map.keyframe(observation.keyframe), observation, camera), number});
      }
      if (is_observed) {
        model.points.push_back({file_world_from_map * landmark.position, landmark.color});
      }
    }
  }
  for (auto& [index, frame] : frames) model.frames.push_back(std::move(frame));
  return model;
}

}  // namespace orb360
