#pragma once

#include <array>

#include <Eigen/Core>

namespace orb360::town {

/// Number of rays and samples that are processed together: one packet of Embree.
inline constexpr int kLanes = 16;

/// One number per lane, aligned for vectors.
struct alignas(64) Lanes : std::array<float, kLanes> {};

/// A vector or a linear colour per lane.
struct Lanes3 {
  Lanes x;  ///< or red
  Lanes y;
  Lanes z;

  Eigen::Vector3f At(size_t lane) const { return {x[lane], y[lane], z[lane]}; }
  void Set(size_t lane, const Eigen::Vector3f& v) {
    x[lane] = v.x();
    y[lane] = v.y();
    z[lane] = v.z();
  }
  void Fill(float value) {
    x.fill(value);
    y.fill(value);
    z.fill(value);
  }
};

}  // namespace orb360::town
