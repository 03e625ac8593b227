#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/scale/position_scale.h"
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/metric_scale.h>
#include <orb360/slam/pipeline/scale_options.h>
#include <orb360/slam/scale/position_fix.h>

namespace orb360 {

struct EstimatedScale {
  /// Scale of each map; with the standard deviation 0 where nothing tells.
  std::vector<ScaleMeasurement> maps;
  MetricScale whole;
  std::vector<KeyframeScale> keyframes;  ///< In the order of the maps and of the keyframes in them.
};

/// Estimates the scale of finished maps, each with the ground over which it has been brought to
/// metres (none: its unit is arbitrary), from all that the keyframes show of the ground, and from
/// positions that something else has measured. It says
/// how true the metres are, and moves nothing. Of several maps the least certain one tells the
/// state, because a result has one unit of length.
EstimatedScale EstimateScale(std::span<const Map> maps,
                             std::span<const std::optional<KnownGround>> grounds,
                             const ScaleOptions& options,
                             std::span<const PositionFix> positions = {});

}  // namespace orb360
