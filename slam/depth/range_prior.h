#pragma once

#include <span>
#include <vector>

#include "slam/depth/dense_depth.h"
#include "slam/features/features.h"
#include "slam/map/map.h"

namespace orb360 {

/// What the completed depth of a keyframe says of those of its features that have no landmark, by
/// feature; of the others it only repeats what their landmarks told it. Nothing is known at edges,
/// where a pixel more or less decides, nor where the network expects an error of a half or more, as
/// in the sky.
std::vector<RangePrior> SampleRangePriors(const DenseDepth& depth, const Features& features,
                                          std::span<const LandmarkId> landmarks);

}  // namespace orb360
