#pragma once

#include <optional>

#include <Eigen/Core>

#include "slam/features/sphere_pyramid.h"
#include <orb360/slam/features/patch.h>

namespace orb360 {

/// Positions of a patch's samples in an image: sample (x, y), counted from the centre, lies at
/// center + steps * (x, y).
struct PatchGrid {
  Eigen::Vector2d center;  // continuous pixel of a pyramid level
  Eigen::Matrix2d steps;   // pixels
};

/// Samples a patch. Returns nullopt where the grid reaches beyond the level's margin.
std::optional<Patch> SamplePatch(const PyramidLevel& level, const PatchGrid& grid);

struct AlignedPatch {
  Eigen::Vector2d center;  // continuous pixel
  PatchSlope slope;        // with what this image adds
};

/// Finds the centre at which `level` shows `patch` by Gauss-Newton steps from a guess that is at
/// most two samples off. The brightness may differ by a factor and an offset. (Inverse
/// compositional alignment: Baker and Matthews, Lucas-Kanade 20 Years On, IJCV 2004.) The surface's
/// slope is estimated too: where it is `s` more than the mean, the steps are stretch * s^T more
/// than those of the guess. Returns nullopt if the two do not look alike, if the patch has
/// structure in one direction only, if the grid reaches beyond the level's margin, or if the
/// surface is seen from behind.
std::optional<AlignedPatch> AlignPatch(const Patch& patch, const PyramidLevel& level,
                                       const PatchGrid& guess, const Eigen::Vector2d& stretch,
                                       const PatchSlope& slope);

}  // namespace orb360
