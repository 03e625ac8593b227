#pragma once

#include <optional>
#include <vector>

#include "slam/optimization/pose_refinement.h"
#include "slam/pipeline/local_map.h"
#include "slam/pipeline/tracked_frame.h"
#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/pipeline/tracker_options.h>

namespace orb360 {

struct TrackResult {
  Rigid3 world_from_camera;
  std::vector<LandmarkId> landmarks;  ///< As in TrackedFrame.
  int num_inliers = 0;
  std::vector<LandmarkId> expected;  ///< Landmarks that should have been seen, ordered by id.
};

/// Estimates the pose of a frame that follows `last`. The landmarks of the last frame are searched
/// around their predicted positions and the pose is refined, then the same is done with the whole
/// local map. Where too few matches agree, other initial poses are tried: P3P in RANSAC from
/// landmarks of the last frame matched from feature to feature, then the motion between both frames
/// (frame_motion.h). The pose with most inliers is the result. Empty where too few landmarks are
/// found. `pixel_sigma` is the angular noise on pyramid level 0, rad. `prior` is what is known
/// of the position before. Runs on `num_threads` OpenMP
/// threads; the result does not depend on their number.
std::optional<TrackResult> TrackFromPrediction(const Features& features,
                                               const Rigid3& predicted_world_from_camera,
                                               const TrackedFrame& last, const LocalMap& local,
                                               double pixel_sigma, const TrackerOptions& options,
                                               const std::optional<PositionPrior>& prior = {},
                                               int num_threads = 1);

/// Estimates the pose of a frame without a prediction: the descriptors of the local map are matched
/// with all features, P3P in RANSAC gives the initial pose, and the rest is as above.
std::optional<TrackResult> TrackWithoutPrediction(const Features& features, const LocalMap& local,
                                                  double pixel_sigma, const TrackerOptions& options,
                                                  int num_threads = 1);

}  // namespace orb360
