#pragma once

#include <span>
#include <vector>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/features/features.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Samples the completed depth of a keyframe at those of its features that have no landmark, one
/// entry per feature. At features with a landmark the depth would only repeat the landmark's range.
/// Nothing is known at edges, where the range changes from pixel to pixel, and where the network
/// expects an error of a half or more, as in the sky.
std::vector<RangePrior> SampleRangePriors(const DenseDepth& depth, const Features& features,
                                          std::span<const LandmarkId> landmarks);

}  // namespace orb360
