#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// Triangles, as numbers of corners, that fill a polygon which is nearly flat: a fan around the
/// first corner where it is convex, else by cutting off ears (Meisters 1975). They turn the way the
/// polygon does. What is left of a polygon that crosses itself becomes a fan.
std::vector<std::array<size_t, 3>> Triangulate(std::span<const Eigen::Vector3f> corners);

}  // namespace orb360::town
