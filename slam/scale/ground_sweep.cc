#include "slam/scale/ground_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "slam/scale/birds_eye_view.h"
#include "slam/scale/shift_polynomial.h"
#include "slam/scale/shift_sweep.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Cells around the common shift in which that of a tile may lie.
constexpr int kTileReach = 3;
constexpr int kMargin = 2 + kFineReach + kTileReach;  // cells, for all of these
// Least cosine of the angle between the ground and the motion.
constexpr double kMinHorizontal = 0.5;
constexpr float kMinTileCorrelation = 0.35f;
// Angle between the assumed normal of the ground across the motion and the one that the tiles show
// up to which the error of the height, 1 - cos, does not matter, rad.
constexpr double kMaxTilt = 0.035;

/// Position of the maximum of a parabola through three values, relative to the middle one.
double ParabolaPeak(double before, double at, double after) {
  return 0.5 * (before - after) / (before - 2 * at + after);
}

Eigen::Vector2d CenterOf(int tile) {
  const auto center = [](int index, int count) { return (index + 0.5 - 0.5 * count) * kTile; };
  return kCell * Eigen::Vector2d(center(tile / kTilesAcross, kTilesAlong),
                                 center(tile % kTilesAcross, kTilesAcross));
}

/// The direction of motion, left and up in the frame of camera 1. The ground is parallel to the
/// motion, or its normal is `up`: the direction of the motion may be the less certain of both.
/// Empty where the motion is too steep.
std::optional<Eigen::Matrix3d> GroundAxes(const Eigen::Vector3d& step, const Eigen::Vector3d& up,
                                          bool is_parallel) {
  const Eigen::Vector3d direction = step.normalized();
  const double rise = direction.dot(up);
  if (!(1 - rise * rise > kMinHorizontal * kMinHorizontal)) return std::nullopt;  // also for NaN
  Eigen::Matrix3d axes;
  axes.col(0) = is_parallel ? direction : (direction - rise * up).normalized();
  axes.col(2) = is_parallel ? (up - rise * direction).normalized() : up;
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// The shifts of the tiles around a common one, along the motion and across it, cells.
struct TileShifts {
  std::vector<TileShift> along;
  std::vector<TileShift> across;
};

TileShifts ShiftsOfTiles(const BirdsEyeView& view1, const BirdsEyeView& view2,
                         const Shift& common) {
  TileShifts shifts;
  for (int tile = 0; tile < kTilesAlong * kTilesAcross; ++tile) {
    const auto value = [&](int along, int across) {
      return CorrelateTile(view1, view2, tile, {common.along + along, common.across + across});
    };
    float best = -1;
    int along = 0;
    int across = 0;
    for (int i = -kTileReach; i <= kTileReach; ++i) {
      for (int j = -kTileReach; j <= kTileReach; ++j) {
        const float here = value(i, j);
        if (here > best) {
          best = here;
          along = i;
          across = j;
        }
      }
    }
    if (best < kMinTileCorrelation || std::abs(along) == kTileReach ||
        std::abs(across) == kTileReach) {
      continue;
    }
    shifts.along.push_back({CenterOf(tile), common.along + along +
                                                ParabolaPeak(value(along - 1, across), best,
                                                             value(along + 1, across))});
    shifts.across.push_back({CenterOf(tile), common.across + across +
                                                 ParabolaPeak(value(along, across - 1), best,
                                                              value(along, across + 1))});
  }
  return shifts;
}

/// Fills in TileShift::per_lens_distance. Where a tile lies ahead of a camera, the lens that looks
/// ahead sees it, from a place half the distance of the lenses ahead of the camera's centre, and so
/// it appears nearer by that; behind it is the other way round. `axis1` and `axis2`: direction of
/// the lens that looks ahead, in the axes of the ground. `common`: shift of all tiles, cells.
void SeeThroughLenses(const Eigen::Vector3d& axis1, const Eigen::Vector3d& axis2,
                      const Shift& common, TileShifts* tiles) {
  constexpr double kHalfTile = 0.5 * kTile * kCell;
  const Eigen::Vector2d half = 0.5 * kCell * Eigen::Vector2d(common.along, common.across);
  const auto add = [&](int component, std::vector<TileShift>* shifts) {
    for (TileShift& tile : *shifts) {
      // Fraction of the tile that lies ahead less that behind.
      const auto side = [&](const Eigen::Vector2d& place, const Eigen::Vector3d& axis) {
        return std::clamp(place.dot(axis.head<2>()) / kHalfTile, -1.0, 1.0) * axis[component];
      };
      tile.per_lens_distance =
          -0.5 * (side(tile.place + half, axis1) - side(tile.place - half, axis2)) / kCell;
    }
  };
  add(0, &tiles->along);
  add(1, &tiles->across);
}

/// A step, if it was measured, whether it is that of the ground straight below alone, and whether
/// several steps look alike.
struct SweptStep {
  std::optional<GroundStep> step = {};
  bool is_below = false;
  bool is_ambiguous = false;
};

/// `axes`: of the ground, in the frame of camera 1.
SweptStep Sweep(const SpherePyramid& image1, const SpherePyramid& image2,
                const Eigen::Quaterniond& camera2_from_camera1, const Eigen::Matrix3d& axes,
                const cv::Mat& mask, const GroundSweepOptions& options) {
  const auto farthest = static_cast<int>(options.max_ratio / kCell);
  // The cells lie ahead of the first camera and behind the second one. All numbers are even.
  const int near = kAlong / 2 + kMargin;
  const int far = near + farthest / 4 * 2 + 2;
  const int half_width = (kAcross + LargestAside(options)) / 4 * 2 + 2 + kMargin;
  BirdsEyeView view1 = LookDown(image1, axes, mask, kCell, -near, far, half_width);
  BirdsEyeView view2 =
      LookDown(image2, camera2_from_camera1 * axes, mask, kCell, -far, near, half_width);
  BirdsEyeView coarse1 = JoinCells(kCoarse, view1);
  BirdsEyeView coarse2 = JoinCells(kCoarse, view2);
  NormalizeLocally(kTile / 2, &view1);
  NormalizeLocally(kTile / 2, &view2);
  NormalizeLocally(kTile / 2 / kCoarse, &coarse1);
  NormalizeLocally(kTile / 2 / kCoarse, &coarse2);
  const SweptShift swept = SweepShift(view1, view2, coarse1, coarse2, options);
  const bool is_below = swept.is_below;
  if (swept.correlation < options.min_correlation) return {.is_below = is_below};
  const bool is_ambiguous = swept.rival > options.max_rival * swept.correlation;
  if (!swept.is_peak || is_ambiguous) return {.is_below = is_below, .is_ambiguous = is_ambiguous};
  const Shift& common = swept.shift;
  TileShifts tiles = ShiftsOfTiles(view1, view2, common);
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitX();
  SeeThroughLenses(axes.transpose() * ahead,
                   axes.transpose() * (camera2_from_camera1.conjugate() * ahead), common, &tiles);
  const double lens_distance = options.lens_distance;
  const std::optional<ShiftBelow> below = FitShifts(tiles.along, lens_distance, options.min_tiles);
  const std::optional<ShiftBelow> aside = FitShifts(tiles.across, lens_distance, options.min_tiles);
  if (!below || !aside) return {.is_below = is_below};
  GroundStep step;
  step.ratio = kCell * std::hypot(below->shift, aside->shift);
  step.sigma = below->sigma / below->shift;
  if (!(step.sigma < options.max_sigma)) return {.is_below = is_below};
  step.correlation = swept.correlation;
  step.rival = swept.rival;
  step.num_tiles = below->num_tiles;
  step.per_lens_distance = kCell * below->per_lens_distance;
  step.lens_distance = FitLensDistance(tiles.along, options.min_tiles);
  step.direction = axes * Eigen::Vector3d(below->shift, aside->shift, 0).normalized();
  // Relief shifts a tile along the motion only, a turn shifts it across in proportion to its place.
  step.turn = kCell * aside->gradient.x();
  step.turn_sigma = kCell * aside->gradient_sigma;
  // The shift is inversely proportional to the height of the camera over a piece of the ground,
  // which is thus 1 - gradient . place.
  const Eigen::Vector2d slope = below->gradient / below->shift;
  step.up = (axes * Eigen::Vector3d(-slope.x(), -slope.y(), 1.0)).normalized();
  return {step, is_below};
}

/// MeasureGroundStep from one guess. `camera2_from_camera1`: rotation.
SweptStep MeasureFrom(const GroundStepGuess& guess, const SpherePyramid& image1,
                      const SpherePyramid& image2, const Eigen::Quaterniond& camera2_from_camera1,
                      const cv::Mat& mask, const GroundSweepOptions& options) {
  for (const bool is_parallel : {true, false}) {
    const std::optional<Eigen::Matrix3d> axes = GroundAxes(guess.direction, guess.up, is_parallel);
    if (!axes) return {};
    const SweptStep swept = Sweep(image1, image2, camera2_from_camera1, *axes, mask, options);
    const std::optional<GroundStep>& step = swept.step;
    if (swept.is_ambiguous) return swept;
    if (!step && swept.is_below) return {};  // The rest is not the ground.
    if (!step) continue;
    const std::optional<Eigen::Matrix3d> seen = GroundAxes(step->direction, step->up, true);
    if (!seen) return {};
    if (seen->col(2).dot(axes->col(2)) > std::cos(kMaxTilt)) return swept;
    return Sweep(image1, image2, camera2_from_camera1, *seen, mask, options);
  }
  return {};
}

}  // namespace

std::optional<GroundStep> MeasureGroundStep(const SpherePyramid& image1,
                                            const SpherePyramid& image2,
                                            const Rigid3& camera1_from_camera2,
                                            const Eigen::Vector3d& up, const cv::Mat& mask,
                                            const GroundSweepOptions& options) {
  const GroundStepGuess guess{camera1_from_camera2.translation, up};
  return MeasureGroundStep(image1, image2, camera1_from_camera2.rotation, std::span(&guess, 1),
                           mask, options);
}

std::optional<GroundStep> MeasureGroundStep(const SpherePyramid& image1,
                                            const SpherePyramid& image2,
                                            const Eigen::Quaterniond& camera1_from_camera2,
                                            std::span<const GroundStepGuess> guesses,
                                            const cv::Mat& mask,
                                            const GroundSweepOptions& options) {
  ORB360_CHECK(0 < options.min_ratio && options.min_ratio < options.max_ratio &&
                   options.max_ratio >= kCoarse * kCell,
               options.min_ratio, options.max_ratio);
  for (const GroundStepGuess& guess : guesses) {
    const SweptStep swept =
        MeasureFrom(guess, image1, image2, camera1_from_camera2.conjugate(), mask, options);
    if (swept.step || swept.is_ambiguous) return swept.step;
  }
  return std::nullopt;
}

}  // namespace orb360
