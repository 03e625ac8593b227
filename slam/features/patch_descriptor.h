#pragma once

#include <cstddef>
#include <cstdint>

#include "slam/features/tangent_sampling.h"
#include <orb360/slam/features/features.h>

namespace orb360 {

/// Orientation and binary descriptor of the patch around one pixel, sampled in the tangent plane.
///
/// The angle is that of the intensity centroid (Rublee et al., ORB, ICCV 2011), radians from east
/// towards south. The descriptor compares 256 pairs of points that are rotated by it. `center`
/// points to the patch's central pixel in a blurred, padded pyramid level whose rows are `stride`
/// bytes apart.
struct OrientedDescriptor {
  float angle;
  Descriptor bits;
};
OrientedDescriptor DescribePatch(const uint8_t* center, ptrdiff_t stride,
                                 const TangentSampling& sampling);

}  // namespace orb360
