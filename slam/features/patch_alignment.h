#pragma once

#include <optional>

#include <Eigen/Core>

#include "slam/features/patch.h"
#include "slam/features/sphere_pyramid.h"

namespace orb360 {

/// Where a patch's samples lie in a picture: sample (x, y), counted from the centre, is at
/// center + steps * (x, y).
struct PatchGrid {
  Eigen::Vector2d center;  // continuous pixel of a pyramid level
  Eigen::Matrix2d steps;   // pixels
};

/// Empty where the grid reaches beyond the level's margin.
std::optional<Patch> SamplePatch(const PyramidLevel& level, const PatchGrid& grid);

struct AlignedPatch {
  Eigen::Vector2d center;  // continuous pixel
  PatchSlope slope;        // with what this picture adds
};

/// The centre at which `level` shows what `patch` shows, by Gauss-Newton steps from a guess that is
/// at most two samples off; the brightness may differ by a factor and an offset. (Inverse
/// compositional: Baker and Matthews, Lucas-Kanade 20 Years On, IJCV 2004.) The surface's slope is
/// estimated with it: where it is `s` more than the mean, the steps are stretch * s^T more than the
/// guess'. Empty where both do not look alike, where the patch has structure in one direction only,
/// beyond the level's margin, and from behind the surface.
std::optional<AlignedPatch> AlignPatch(const Patch& patch, const PyramidLevel& level,
                                       const PatchGrid& guess, const Eigen::Vector2d& stretch,
                                       const PatchSlope& slope);

}  // namespace orb360
