#pragma once

#include "slam/features/features.h"

namespace orb360 {

/// Makes what is found from keypoints and bearings: `grid` and `corners`.
///
/// Most corners are found on several neighbouring levels of the pyramid. A feature shows the corner
/// of the nearest one on the next finer level if that lies within two standard deviations of its
/// own position. What is no corner stands for itself, and is not found.
void IndexFeatures(Features* features);

}  // namespace orb360
