#pragma once

#include "slam/scale/birds_eye_view.h"
#include "slam/scale/ground_sweep.h"

namespace orb360 {

// Distances on the ground are in heights of the camera.
inline constexpr double kCell = 0.02;  // side of a cell of the bird's-eye view
inline constexpr int kTile = 16;       // cells on each side of a tile
inline constexpr int kAlong = static_cast<int>(2 * kGroundSweepAlong / kCell + 0.5);    // cells
inline constexpr int kAcross = static_cast<int>(2 * kGroundSweepAcross / kCell + 0.5);  // cells
static_assert(kAlong % (2 * kTile) == 0 && kAcross % (2 * kTile) == 0);
inline constexpr int kTilesAlong = kAlong / kTile;
inline constexpr int kTilesAcross = kAcross / kTile;
// The first sweep joins this many cells in each direction.
inline constexpr int kCoarse = 2;
// Cells around the result of the first sweep in which the second one searches.
inline constexpr int kFineReach = 3;

/// A shift from one view to the other: along the motion, and across it, in cells.
struct Shift {
  int along;
  int across;
};

/// The correlation of a tile in both views. The tiles lie symmetrically about the point half-way
/// between the cameras: ahead of the first one, behind the second one.
float CorrelateTile(const BirdsEyeView& view1, const BirdsEyeView& view2, int tile,
                    const Shift& shift);

/// Largest shift across the direction of motion, cells.
inline int LargestAside(const GroundSweepOptions& options) {
  return static_cast<int>(options.max_aside / kCell + 0.5);
}

/// The shift at which two views of the ground correlate best.
struct SweptShift {
  Shift shift = {};        ///< Cells.
  double correlation = 0;  ///< Mean correlation of the tiles.
  double rival = 0;        ///< The largest one at any other shift along the motion.
  /// Whether only the tiles straight below have it, because the ground there lies higher.
  bool is_below = false;
  /// Whether it is not at an end of the sweep, and no motion correlates less.
  bool is_peak = false;
};

/// Sweeps the shift of one view against the other over the range of the options, first in coarse
/// views, whose cells are kCoarse cells wide, then around the best one. The cells that are read lie
/// up to kFineReach beyond the largest shifts.
SweptShift SweepShift(const BirdsEyeView& view1, const BirdsEyeView& view2,
                      const BirdsEyeView& coarse1, const BirdsEyeView& coarse2,
                      const GroundSweepOptions& options);

}  // namespace orb360
