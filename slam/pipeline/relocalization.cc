#include "slam/pipeline/relocalization.h"

#include <utility>

namespace orb360 {

std::optional<Relocalization> Relocalize(const Features& features, const LocalMap& local,
                                         double pixel_sigma, const Options& options,
                                         int num_threads, Atlas* atlas, KeyframeId* next_keyframe) {
  const int present = atlas->present_number();
  const Map& map = atlas->map();
  const auto look_around = [&](const LocalMap& place) {
    return TrackWithoutPrediction(features, place, pixel_sigma, options.tracker, num_threads);
  };
  if (std::optional<TrackResult> result = look_around(local)) {
    return Relocalization{.map = present, .local = local, .result = std::move(*result)};
  }
  if (options.loop.enabled) {
    if (auto found = atlas->places().FindPose(features, map, atlas->finished(), num_threads)) {
      return Relocalization{
          .map = found->map, .local = std::move(found->local), .result = std::move(found->result)};
    }
  }
  for (int i = 0; i < options.recovery.keyframes_per_frame; ++i) {
    constexpr int kStep = 3;  // Neighbouring keyframes see the same landmarks.
    if (*next_keyframe < 0) *next_keyframe = map.keyframe_end() - 1;
    const KeyframeId id = map.LivingKeyframe(*next_keyframe);
    *next_keyframe -= kStep;
    LocalMap around = MakeLocalMap(map, id, options.keyframe.local_keyframes);
    if (std::optional<TrackResult> result = look_around(around)) {
      return Relocalization{
          .map = present, .local = std::move(around), .result = std::move(*result)};
    }
  }
  return std::nullopt;
}

}  // namespace orb360
