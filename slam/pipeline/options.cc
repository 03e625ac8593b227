#include "slam/pipeline/options.h"

namespace orb360 {

ConfigSchema MakeConfigSchema(Options* options) {
  ConfigSchema schema;
  schema.Add("optimizer", &options->mapper.bundle.optimizer,
             "solver of bundle adjustment and of pose graphs; ceres is slower, to compare with",
             kOptimizerNames);
  OrbOptions& orb = options->orb;
  schema.Add("features.count", &orb.num_features, "features sought in each image", 100, 20000);
  schema.Add("features.levels", &orb.num_levels,
             "levels of the image pyramid, each 2^(1/4) times smaller than the one before", 1, 8);
  schema.Add("features.min_score", &orb.min_score,
             "least difference of a corner from its surroundings, grey levels", 1, 255);
  schema.Add("features.pixel_sigma", &orb.pixel_sigma,
             "standard deviation of a feature's position, pixels of its pyramid level", 0.05, 10.0);

  InitializerOptions& initializer = options->initializer;
  schema.Add("initializer.nearby_radius", &initializer.nearby_radius,
             "angle within which two views are matched at first, radians", 0.01, 3.2);
  schema.Add("initializer.min_landmarks", &initializer.min_landmarks,
             "landmarks that the first map must have", 20, 10000);
  schema.Add("initializer.min_parallax", &initializer.min_parallax,
             "median parallax of what is not far away in the two views, radians", 0.001, 1.0);
  schema.Add("initializer.min_parallax_sigmas", &initializer.min_parallax_sigmas,
             "the same, standard deviations of a feature", 0.0, 100.0);
  schema.Add("initializer.min_landmark_parallax", &initializer.min_landmark_parallax,
             "least parallax of a single landmark, radians", 0.001, 1.0);
  schema.Add("initializer.min_inlier_ratio", &initializer.min_inlier_ratio,
             "fraction of the matches that must agree with the motion", 0.1, 1.0);

  TrackerOptions& tracker = options->tracker;
  schema.Add("tracker.motion_radius", &tracker.motion_radius,
             "search window around predicted landmarks, radians", 0.005, 1.0);
  schema.Add("tracker.nearby_radius", &tracker.nearby_radius,
             "angle within which frames are matched when the prediction fails, radians", 0.01, 3.2);
  schema.Add("tracker.local_radius_sigmas", &tracker.local_radius_sigmas,
             "search window for the local map, standard deviations of a feature", 1.0, 50.0);
  schema.Add("tracker.min_motion_inliers", &tracker.min_motion_inliers,
             "landmarks of the last frame that must be found again", 6, 1000);
  schema.Add("tracker.min_inlier_ratio", &tracker.min_inlier_ratio,
             "fraction of matches with the local map that must agree, or another start is tried",
             0.0, 1.0);
  schema.Add("tracker.min_inliers", &tracker.min_inliers,
             "landmarks of the local map that make a frame tracked", 6, 1000);

  KeyframeOptions& keyframe = options->keyframe;
  schema.Add("keyframe.min_tracked_fraction", &keyframe.min_tracked_fraction,
             "a new keyframe when fewer of its reference's landmarks are tracked", 0.0, 1.0);
  schema.Add("keyframe.max_motion", &keyframe.max_motion,
             "a new keyframe after moving this fraction of the surroundings' median range", 0.0,
             10.0);
  schema.Add("keyframe.min_motion", &keyframe.min_motion,
             "no new keyframe before moving this fraction of the surroundings' median range", 0.0,
             10.0);
  schema.Add("keyframe.mapping_frames", &keyframe.mapping_frames,
             "frames after which the mapping of a keyframe is adopted", 1, 100);
  schema.Add("keyframe.min_held_fraction", &keyframe.min_held_fraction,
             "earlier when fewer of its landmarks are still tracked", 0.0, 1.0);
  schema.Add("keyframe.urgent_inliers", &keyframe.urgent_inliers,
             "with fewer tracked landmarks a keyframe is made, and adopted at once", 0, 10000);
  schema.Add("keyframe.local_keyframes", &keyframe.local_keyframes,
             "neighbouring keyframes whose landmarks are searched in each frame", 1, 1000);

  TriangulationOptions& triangulation = options->mapper.triangulation;
  schema.Add("triangulation.max_neighbours", &triangulation.max_neighbours,
             "keyframes with which a new one is matched", 1, 100);
  schema.Add("triangulation.min_baseline", &triangulation.min_baseline,
             "shortest baseline, fraction of the median range", 0.0, 1.0);
  schema.Add("triangulation.max_plane_sigmas", &triangulation.max_plane_sigmas,
             "farthest match from its epipolar plane, standard deviations", 0.5, 10.0);
  schema.Add("triangulation.min_epipole_angle", &triangulation.min_epipole_angle,
             "least angle to the epipole, radians", 0.0, 0.5);
  schema.Add("triangulation.min_parallax", &triangulation.min_parallax,
             "least parallax of a new landmark, radians", 0.0001, 0.5);
  schema.Add("triangulation.min_parallax_sigmas", &triangulation.min_parallax_sigmas,
             "least parallax of a new landmark, standard deviations", 0.0, 20.0);
  schema.Add("triangulation.max_parallax", &triangulation.max_parallax,
             "largest parallax of a new landmark, radians", 0.1, 1.5);
  schema.Add("triangulation.max_scale_ratio", &triangulation.max_scale_ratio,
             "largest disagreement between ranges and feature scales, a factor", 1.0, 10.0);
  schema.Add("triangulation.max_range_sigmas", &triangulation.max_range_sigmas,
             "farthest range from what completed depth says, standard deviations", 0.5, 100.0);

  MapperOptions& mapper = options->mapper;
  schema.Add("bundle.max_keyframes", &mapper.bundle.max_keyframes,
             "keyframes that local bundle adjustment moves", 2, 1000);
  schema.Add("bundle.max_fixed_keyframes", &mapper.bundle.max_fixed_keyframes,
             "keyframes around them that hold the landmarks in place", 0, 1000);
  schema.Add("bundle.min_shared", &mapper.bundle.min_shared,
             "landmarks a keyframe must share with the newest to be moved", 1, 10000);
  schema.Add("bundle.max_iterations", &mapper.bundle.max_iterations,
             "iterations of local bundle adjustment", 1, 1000);
  schema.Add("mapper.max_fusion_neighbours", &mapper.max_fusion_neighbours,
             "keyframes with which a new one exchanges landmarks", 1, 100);
  schema.Add("mapper.redundant_fraction", &mapper.redundant_fraction,
             "a keyframe is dropped when three others see this fraction of its landmarks", 0.5,
             1.0);
  schema.Add("mapper.probation_keyframes", &mapper.probation_keyframes,
             "keyframes after which a landmark must have been seen three times", 1, 100);
  schema.Add("mapper.min_found_fraction", &mapper.min_found_fraction,
             "fraction of the frames in which a landmark on probation must be found", 0.0, 1.0);
  schema.Add("mapper.kept_images", &mapper.kept_images,
             "newest keyframes whose images are kept, to align what they show of landmarks", 1,
             1000);

  RecoveryOptions& recovery = options->recovery;
  schema.Add("recovery.patience_frames", &recovery.patience_frames,
             "frames after a loss before a new map may be begun", 1, 100000);
  schema.Add("recovery.keyframes_per_frame", &recovery.keyframes_per_frame,
             "keyframes in which a lost frame is sought", 1, 1000);
  schema.Add("recovery.max_pending_frames", &recovery.max_pending_frames,
             "frames without a pose that are remembered to be tracked later", 1, 100000);

  ScaleOptions& scale = options->scale;
  schema.Add(
      "camera.height_m", &scale.camera_height,
      "height of the camera over the ground, metres: what makes the result metric; 0: as the "
      "input says, or 1.6",
      0.0, 100.0);
  schema.Add("scale.from_ground", &scale.from_ground,
             "find the ground below the camera and keep the scale by it");
  schema.Add("scale.height_sigma", &mapper.bundle.height_sigma,
             "standard deviation of the camera's height over the ground, a fraction of it", 0.001,
             1.0);

  DepthOptions& depth = options->depth;
  schema.Add("depth.height", &depth.height,
             "height of the images that get dense depth, pixels; they are twice as wide", 32, 4096);
  schema.Add("depth.every_keyframes", &depth.every_keyframes,
             "every so many keyframes get dense depth", 1, 1000);
  schema.Add("depth.min_points", &depth.min_points,
             "landmarks that a keyframe must show to be completed", 1, 100000);
  schema.Add("depth.adoption_frames", &depth.adoption_frames,
             "frames after which the depth of a keyframe is used in mapping", 1, 1000);

  LoopOptions& loop = options->loop;
  schema.Add("loop.enabled", &loop.enabled,
             "recognise places: close loops, join maps, find a lost camera by what it sees");
  schema.Add("loop.min_similarity", &loop.min_similarity,
             "a place is looked at when it is like the image, fraction of the keyframe before", 0.0,
             10.0);
  schema.Add("loop.max_candidates", &loop.max_candidates, "places looked at for each lost frame", 1,
             100);
  schema.Add("loop.min_inliers", &loop.min_inliers,
             "landmarks of a place that must be found in the image", 10, 10000);
  schema.Add("loop.min_found_fraction", &loop.min_found_fraction,
             "fraction of the place's landmarks in view that must be found", 0.0, 1.0);
  schema.Add("loop.min_agreeing", &loop.min_agreeing,
             "keyframes that must lead to the same correction", 1, 100);
  schema.Add("loop.max_disagreement", &loop.max_disagreement,
             "difference of corrections: fraction of the median range, radians, log of the scale",
             0.0, 1.0);
  schema.Add("loop.min_length", &loop.min_length,
             "least length of a loop, multiples of the median range", 0.0, 10000.0);
  schema.Add("loop.max_drift", &loop.max_drift,
             "farthest that a map can have drifted, fraction of the way round the loop", 0.0, 10.0);
  schema.Add("loop.max_turn", &loop.max_turn, "the same for directions, radians", 0.0, 3.2);
  schema.Add("loop.max_scale", &loop.max_scale, "the same for the scale, a factor", 1.0, 100.0);
  schema.Add("loop.correction_frames", &loop.correction_frames,
             "frames after which the correction of a loop is adopted", 1, 1000);
  schema.Add("loop.bundle_frames", &loop.bundle_frames,
             "frames after which a bundle adjustment of the whole map is adopted, by keyframe", 0.0,
             100.0);
  schema.Add("loop.bundle_iterations", &loop.bundle_iterations,
             "iterations of each round of the bundle adjustment of the whole map", 1, 1000);
  schema.Add("loop.height_sigma", &loop.height_sigma,
             "scale.height_sigma in the bundle adjustment of the whole map", 0.001, 1.0);
  return schema;
}

}  // namespace orb360
