#pragma once

#include <orb360/slam/features/features.h>

namespace orb360 {

/// Computes `grid` and `corners` from keypoints and bearings.
///
/// Most corners are found on several neighbouring levels of the pyramid. A feature shows the corner
/// of the nearest feature on the next finer level if that lies within two standard deviations of
/// its own position. A feature that is not a corner is a corner of its own and is not found through
/// `grid`.
void IndexFeatures(Features* features);

}  // namespace orb360
