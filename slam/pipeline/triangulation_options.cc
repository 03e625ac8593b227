#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/triangulation_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, TriangulationOptions* options) {
  schema->Add("triangulation.max_neighbours", &options->max_neighbours,
              "keyframes with which a new one is matched", 1, 100);
  schema->Add("triangulation.min_baseline", &options->min_baseline,
              "shortest baseline, fraction of the median range", 0.0, 1.0);
  schema->Add("triangulation.max_plane_sigmas", &options->max_plane_sigmas,
              "farthest match from its epipolar plane, standard deviations", 0.5, 10.0);
  schema->Add("triangulation.min_epipole_angle", &options->min_epipole_angle,
              "least angle to the epipole, radians", 0.0, 0.5);
  schema->Add("triangulation.min_parallax", &options->min_parallax,
              "least parallax of a new landmark, radians", 0.0001, 0.5);
  schema->Add("triangulation.min_parallax_sigmas", &options->min_parallax_sigmas,
              "least parallax of a new landmark, standard deviations", 0.0, 20.0);
  schema->Add("triangulation.max_parallax", &options->max_parallax,
              "largest parallax of a new landmark, radians", 0.1, 1.5);
  schema->Add("triangulation.max_scale_ratio", &options->max_scale_ratio,
              "largest disagreement between ranges and feature scales, a factor", 1.0, 10.0);
  schema->Add("triangulation.max_range_sigmas", &options->max_range_sigmas,
              "farthest range from what completed depth says, standard deviations", 0.5, 100.0);
}

}  // namespace orb360
