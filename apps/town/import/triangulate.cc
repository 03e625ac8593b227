#include "apps/town/import/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace orb360::town {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Twice the signed area of a triangle.
double Area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Returns the corners in the polygon's plane, in which it turns counter-clockwise.
std::vector<Vector2d> Flatten(std::span<const Eigen::Vector3f> corners) {
  const Vector3d origin = corners[0].cast<double>();
  Vector3d normal = Vector3d::Zero();  // Newell's: of any polygon, flat or not
  for (size_t i = 0; i < corners.size(); ++i) {
    normal += (corners[i].cast<double>() - origin)
                  .cross(corners[(i + 1) % corners.size()].cast<double>() - origin);
  }
  normal.stableNormalize();
  if (!(normal.squaredNorm() > 0.5)) normal = Vector3d::UnitZ();
  const Vector3d x = normal.unitOrthogonal();
  const Vector3d y = normal.cross(x);
  std::vector<Vector2d> flat;
  for (const Eigen::Vector3f& corner : corners) {
    const Vector3d p = corner.cast<double>() - origin;
    flat.emplace_back(p.dot(x), p.dot(y));
  }
  return flat;
}

}  // namespace

std::vector<std::array<size_t, 3>> Triangulate(std::span<const Eigen::Vector3f> corners) {
  std::vector<std::array<size_t, 3>> triangles;
  if (corners.size() < 3) return triangles;
  const std::vector<Vector2d> flat = Flatten(corners);
  std::vector<size_t> left(corners.size());  // the corners of what is not filled yet
  std::iota(left.begin(), left.end(), 0);
  const auto area_at = [&](size_t i) {
    const size_t n = left.size();
    return Area(flat[left[(i + n - 1) % n]], flat[left[i]], flat[left[(i + 1) % n]]);
  };
  const auto is_ear = [&](size_t i) {
    const size_t n = left.size();
    const size_t a = left[(i + n - 1) % n];
    const size_t b = left[i];
    const size_t c = left[(i + 1) % n];
    if (area_at(i) <= 0) return false;
    return std::none_of(left.begin(), left.end(), [&](size_t p) {
      if (flat[p] == flat[a] || flat[p] == flat[b] || flat[p] == flat[c]) return false;
      return Area(flat[a], flat[b], flat[p]) >= 0 && Area(flat[b], flat[c], flat[p]) >= 0 &&
             Area(flat[c], flat[a], flat[p]) >= 0;
    });
  };
  const auto is_convex = [&] {
    for (size_t i = 0; i < left.size(); ++i) {
      if (area_at(i) < 0) return false;
    }
    return true;
  };
  bool found = !is_convex();
  while (left.size() > 3 && found) {
    found = false;
    for (size_t i = 0; i < left.size() && !found; ++i) {
      if (!is_ear(i)) continue;
      const size_t n = left.size();
      triangles.push_back({left[(i + n - 1) % n], left[i], left[(i + 1) % n]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
      found = true;
    }
  }
  for (size_t i = 2; i < left.size(); ++i) triangles.push_back({left[0], left[i - 1], left[i]});
  return triangles;
}

}  // namespace orb360::town
