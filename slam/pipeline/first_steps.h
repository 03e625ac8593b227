#pragma once

#include <opencv2/core.hpp>

#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Brings the keyframes from before the ground was known to where their steps over it say that they
/// were, starting from the newest one. Steps that they lack are measured now. Two views of far
/// landmarks tell little of the distance between them, and so the first keyframes may be wrong by
/// factors. A step that cannot be measured is replaced by the one after it where it is far from
/// that. What they see is triangulated anew. `mask`: see MeasureGroundSteps.
///
/// Does nothing in a map of more than kGroundSearch keyframes or with keyframes of an earlier run:
/// these hold each other by common landmarks, which a move of all earlier ones would tear.
void AlignFirstKeyframes(const KnownGround& ground, const cv::Mat& mask, Map* map);

}  // namespace orb360
