#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Number of keyframes within which the ground is sought eagerly.
inline constexpr KeyframeId kGroundSearch = 15;

/// Whether the ground is being sought for the next keyframe of a map: keyframes are then made close
/// to each other and adopted at once, and none of them is redundant.
inline bool SeeksGround(const Map& map, bool has_ground) {
  return !has_ground && map.keyframe_end() < kGroundSearch;
}

/// Measures the steps from the last keyframes before `id` to it on the ground that the images show
/// (MeasureGroundStep), and stores them in the keyframe. `mask` removes what moves with the camera
/// (CV_8U, 0: not used; may be empty).
void MeasureGroundSteps(KeyframeId id, const std::optional<KnownGround>& ground,
                        const cv::Mat& mask, Map* map);

/// Returns how far the step to a keyframe from the one but last before it is from the sum of the
/// two steps between, as a fraction of its length. These are three measurements of other pairs of
/// images. Empty where one of them is missing.
std::optional<double> MisclosureOfSteps(const Map& map, KeyframeId id);

/// The pose of a keyframe as its step over the ground from another keyframe's pose shows it: moved
/// and turned about the vertical. Empty where `to` agrees with the step within their errors.
std::optional<Rigid3> PoseByStep(const GroundStepFrom& step, const Rigid3& from, const Rigid3& to,
                                 double camera_height);

/// Moves and turns a keyframe so that the step from the keyframe before it is the one that the
/// ground shows, and triangulates the landmarks that contradict this anew. Does nothing where
/// length and turn agree with it within their errors.
void CorrectStep(KeyframeId id, const KnownGround& ground, Map* map);

}  // namespace orb360
