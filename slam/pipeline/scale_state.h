#pragma once

#include <optional>
#include <span>
#include <vector>

#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/metric_scale.h>
#include <orb360/slam/pipeline/scale_options.h>

namespace orb360 {

struct EstimatedScale {
  /// ln(true length / length in the map) of each map; 0 where the images do not show the ground.
  std::vector<double> map_log_scales;
  MetricScale whole;
  std::vector<KeyframeScale> keyframes;  ///< In the order of the maps and of the keyframes in them.
};

/// Estimates the scale of finished maps, each with the ground over which it has been brought to
/// metres (none: its unit is arbitrary), from all that the keyframes show of the ground. It says
/// how true the metres are, and moves nothing. Of several maps the least certain one tells the
/// state, because a result has one unit of length.
EstimatedScale EstimateScale(std::span<const Map> maps,
                             std::span<const std::optional<KnownGround>> grounds,
                             const ScaleOptions& options);

}  // namespace orb360
