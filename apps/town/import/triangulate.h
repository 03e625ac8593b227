#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// Returns triangles, as indices of corners, that fill a nearly flat polygon: a fan around the
/// first corner if it is convex, otherwise by cutting off ears (Meisters 1975). They have the
/// orientation of the polygon. The rest of a polygon that crosses itself becomes a fan.
std::vector<std::array<size_t, 3>> Triangulate(std::span<const Eigen::Vector3f> corners);

}  // namespace orb360::town
