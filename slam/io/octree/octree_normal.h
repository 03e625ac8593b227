#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace orb360 {

/// A unit vector in 16 bits: the two coordinates of its octahedral projection (Meyer et al., On
/// Floating-Point Normal Vectors, 2010), each in 1..255, the first in the lower byte. The error is
/// at most 1 degree. 0 for a vector without a length.
std::uint16_t OctahedralNormal(const Eigen::Vector3f& normal);

/// The inverse; a zero vector for 0.
Eigen::Vector3f NormalFromOctahedral(std::uint16_t code);

}  // namespace orb360
