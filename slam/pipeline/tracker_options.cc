#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/tracker_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, TrackerOptions* options) {
  schema->Add("tracker.motion_radius", &options->motion_radius,
              "search window around predicted landmarks, radians", 0.005, 1.0);
  schema->Add("tracker.nearby_radius", &options->nearby_radius,
              "angle within which frames are matched when the prediction fails, radians", 0.01,
              3.2);
  schema->Add("tracker.local_radius_sigmas", &options->local_radius_sigmas,
              "search window for the local map, standard deviations of a feature", 1.0, 50.0);
  schema->Add("tracker.min_motion_inliers", &options->min_motion_inliers,
              "landmarks of the last frame that must be found again", 6, 1000);
  schema->Add("tracker.min_inlier_ratio", &options->min_inlier_ratio,
              "fraction of matches with the local map that must agree, or another start is tried",
              0.0, 1.0);
  schema->Add("tracker.min_inliers", &options->min_inliers,
              "landmarks of the local map that make a frame tracked", 6, 1000);
}

}  // namespace orb360
