#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/pipeline/frame_anchor.h"
#include "slam/scale/scale_measurement.h"
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
/// positions that something else has measured (AlignPositions). It says how true the metres are,
/// and moves nothing. Of several maps the least certain one tells the state, because a result has
/// one unit of length. The offset of the positions' clock is found along the longest map and is
/// known in the others. `frames`: all frames with a pose, between which the path is interpolated
/// (none: between keyframes).
EstimatedScale EstimateScale(std::span<const Map> maps,
                             std::span<const std::optional<KnownGround>> grounds,
                             const ScaleOptions& options, const Positions& positions = {},
                             const FrameAnchors& frames = {});

}  // namespace orb360
