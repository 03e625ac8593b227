#include "slam/scale/ground_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "slam/scale/birds_eye_view.h"
#include "slam/scale/shift_polynomial.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Distances on the ground are in heights of the camera.
constexpr double kCell = 0.02;  // side of a cell of the bird's-eye view
constexpr int kTile = 16;       // cells on each side of a tile
constexpr int kAlong = static_cast<int>(2 * kGroundSweepAlong / kCell + 0.5);    // cells
constexpr int kAcross = static_cast<int>(2 * kGroundSweepAcross / kCell + 0.5);  // cells
static_assert(kAlong % (2 * kTile) == 0 && kAcross % (2 * kTile) == 0);
constexpr int kTilesAlong = kAlong / kTile;
constexpr int kTilesAcross = kAcross / kTile;
constexpr int kTilesBelow = 4;
// The first sweep joins this many cells in each direction.
constexpr int kCoarse = 2;
// Cells around the result of the first sweep in which the second one searches, and around that in
// which the shift of a tile may lie.
constexpr int kFineReach = 3;
constexpr int kTileReach = 3;
constexpr int kMargin = 2 + kFineReach + kTileReach;  // cells, for all of these
// Least cosine of the angle between the ground and the motion.
constexpr double kMinHorizontal = 0.5;
constexpr float kMinTileCorrelation = 0.35f;
// Where the tiles straight below correlate that well at a shift that is larger by this factor, and
// better by the lead than at the shift of the rest, the camera is above a dam, a bridge or a
// terrace: its height is that over the ground straight below, and the rest lies lower. On the
// recordings of docs/results/scale.md without a dam, no pair of images one frame apart passes.
constexpr float kMinBelow = 0.5f;
constexpr float kBelowLead = 0.15f;
constexpr double kMinElevation = 1.15;
// Angle between the assumed normal of the ground across the motion and the one that the tiles show
// up to which the error of the height, 1 - cos, does not matter, rad.
constexpr double kMaxTilt = 0.035;

/// Largest shift across the direction of motion, cells.
int Aside(const GroundSweepOptions& options) {
  return static_cast<int>(options.max_aside / kCell + 0.5);
}

/// Mean product of a square of both views.
template <int kSide>
float Correlate(const BirdsEyeView& view1, int along1, int across1, const BirdsEyeView& view2,
                int along2, int across2) {
  // Sums by column, so that the loop is vectorized in a fixed order.
  float sums[kSide] = {};
  for (int row = 0; row < kSide; ++row) {
    const float* a = view1.At(along1 + row, across1);
    const float* b = view2.At(along2 + row, across2);
    for (int i = 0; i < kSide; ++i) sums[i] += a[i] * b[i];
  }
  float sum = 0;
  for (const float value : sums) sum += value;
  return sum / (kSide * kSide);
}

/// A shift from one view to the other: along the motion, and across it, in cells.
struct Shift {
  int along;
  int across;
};

/// The correlation of a tile, kSide cells on each side. The tiles lie symmetrically about the point
/// half-way between the cameras: ahead of the first one, behind the second one.
template <int kSide>
float CorrelateTile(const BirdsEyeView& view1, const BirdsEyeView& view2, int tile,
                    const Shift& shift) {
  const int along = (tile / kTilesAcross - kTilesAlong / 2) * kSide;
  const int across = (tile % kTilesAcross - kTilesAcross / 2) * kSide;
  const auto half = [](int s) { return s >> 1; };  // rounded down
  return Correlate<kSide>(view1, along + shift.along - half(shift.along),
                          across + shift.across - half(shift.across), view2,
                          along - half(shift.along), across - half(shift.across));
}

/// Whether a tile is one of the four straight below the point half-way.
bool IsBelow(int tile) {
  const int along = tile / kTilesAcross - kTilesAlong / 2;
  const int across = tile % kTilesAcross - kTilesAcross / 2;
  return (along == -1 || along == 0) && (across == -1 || across == 0);
}

/// Mean correlations of all tiles and of those straight below.
struct TileCorrelation {
  float all = 0;
  float below = 0;
};

template <int kSide>
TileCorrelation MeanCorrelation(const BirdsEyeView& view1, const BirdsEyeView& view2,
                                const Shift& shift) {
  TileCorrelation sum;
  for (int tile = 0; tile < kTilesAlong * kTilesAcross; ++tile) {
    const float value = CorrelateTile<kSide>(view1, view2, tile, shift);
    sum.all += value;
    if (IsBelow(tile)) sum.below += value;
  }
  return {sum.all / (kTilesAlong * kTilesAcross), sum.below / kTilesBelow};
}

/// Position of the maximum of a parabola through three values, relative to the middle one.
double ParabolaPeak(double before, double at, double after) {
  return 0.5 * (before - after) / (before - 2 * at + after);
}

/// How well each shift along the motion correlates, with the best shift across it.
struct ShiftProfile {
  std::vector<Shift> shifts;
  std::vector<float> values;

  void Add(const Shift& shift, float value) {
    if (shifts.empty() || shifts.back().along != shift.along) {
      shifts.push_back(shift);
      values.push_back(value);
    } else if (value > values.back()) {
      shifts.back() = shift;
      values.back() = value;
    }
  }
  size_t Top() const { return std::ranges::max_element(values) - values.begin(); }
  /// Whether the best shift is not at the end of those that were tried.
  bool IsInside(size_t top, int aside) const {
    return top > 0 && top + 1 < values.size() && std::abs(shifts[top].across) < aside;
  }
  /// The largest of the other maxima.
  double Rival(size_t top) const {
    double rival = 0;
    for (size_t i = 1; i + 1 < values.size(); ++i) {
      if (i == top || values[i] < values[i - 1] || values[i] < values[i + 1]) continue;
      rival = std::max<double>(rival, values[i]);
    }
    return rival;
  }
};

struct CoarseShift {
  Shift shift;  // cells of the coarse views
  double correlation;
  double rival;
  bool is_below;  // whether only the ground straight below has this shift
};

/// Sweeps both shifts over the whole range. Empty where the best one is at its end.
std::optional<CoarseShift> SweepCoarsely(const BirdsEyeView& view1, const BirdsEyeView& view2,
                                         const GroundSweepOptions& options) {
  constexpr int kSide = kTile / kCoarse;
  const int aside = Aside(options) / kCoarse;
  const int first = std::max(1, static_cast<int>(options.min_ratio / (kCoarse * kCell)));
  const int last = static_cast<int>(options.max_ratio / (kCoarse * kCell));
  ShiftProfile all;
  ShiftProfile below;
  for (int along = first; along <= last; ++along) {
    for (int across = -aside; across <= aside; ++across) {
      const Shift shift{along, across};
      const TileCorrelation value = MeanCorrelation<kSide>(view1, view2, shift);
      all.Add(shift, value.all);
      below.Add(shift, value.below);
    }
  }
  const size_t top = all.Top();
  const size_t top_below = below.Top();
  const float there = MeanCorrelation<kSide>(view1, view2, all.shifts[top]).below;
  const float value = below.values[top_below];
  const bool is_below = below.shifts[top_below].along > kMinElevation * all.shifts[top].along &&
                        value > kMinBelow && value > there + kBelowLead;
  const ShiftProfile& profile = is_below ? below : all;
  const size_t best = is_below ? top_below : top;
  if (!profile.IsInside(best, aside)) return std::nullopt;
  return CoarseShift{profile.shifts[best], profile.values[best], profile.Rival(best), is_below};
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
      return CorrelateTile<kTile>(view1, view2, tile,
                                  {common.along + along, common.across + across});
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

/// `axes`: of the ground, in the frame of camera 1.
std::optional<GroundStep> Sweep(const SpherePyramid& image1, const SpherePyramid& image2,
                                const Eigen::Quaterniond& camera2_from_camera1,
                                const Eigen::Matrix3d& axes, const cv::Mat& mask,
                                const GroundSweepOptions& options) {
  const auto farthest = static_cast<int>(options.max_ratio / kCell);
  // The cells lie ahead of the first camera and behind the second one. All numbers are even.
  const int near = kAlong / 2 + kMargin;
  const int far = near + farthest / 4 * 2 + 2;
  const int half_width = (kAcross + Aside(options)) / 4 * 2 + 2 + kMargin;
  BirdsEyeView view1 = LookDown(image1, axes, mask, kCell, -near, far, half_width);
  BirdsEyeView view2 =
      LookDown(image2, camera2_from_camera1 * axes, mask, kCell, -far, near, half_width);
  BirdsEyeView coarse1 = JoinCells(kCoarse, view1);
  BirdsEyeView coarse2 = JoinCells(kCoarse, view2);
  NormalizeLocally(kTile / 2, &view1);
  NormalizeLocally(kTile / 2, &view2);
  NormalizeLocally(kTile / 2 / kCoarse, &coarse1);
  NormalizeLocally(kTile / 2 / kCoarse, &coarse2);
  const std::optional<CoarseShift> coarse = SweepCoarsely(coarse1, coarse2, options);
  if (!coarse || coarse->correlation < options.min_correlation ||
      coarse->rival > options.max_rival * coarse->correlation) {
    return std::nullopt;
  }
  Shift common{};
  float best = -1;
  for (int i = -kFineReach; i <= kFineReach; ++i) {
    for (int j = -kFineReach; j <= kFineReach; ++j) {
      const Shift shift{kCoarse * coarse->shift.along + i, kCoarse * coarse->shift.across + j};
      const TileCorrelation values = MeanCorrelation<kTile>(view1, view2, shift);
      const float value = coarse->is_below ? values.below : values.all;
      if (value <= best) continue;
      best = value;
      common = shift;
    }
  }
  TileShifts tiles = ShiftsOfTiles(view1, view2, common);
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitX();
  SeeThroughLenses(axes.transpose() * ahead,
                   axes.transpose() * (camera2_from_camera1.conjugate() * ahead), common, &tiles);
  const double lens_distance = options.lens_distance;
  const std::optional<ShiftBelow> below = FitShifts(tiles.along, lens_distance, options.min_tiles);
  const std::optional<ShiftBelow> aside = FitShifts(tiles.across, lens_distance, options.min_tiles);
  if (!below || !aside) return std::nullopt;
  GroundStep step;
  step.ratio = kCell * std::hypot(below->shift, aside->shift);
  step.sigma = below->sigma / below->shift;
  if (!(step.sigma < options.max_sigma)) return std::nullopt;
  step.correlation = coarse->correlation;
  step.rival = coarse->rival;
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
  return step;
}

}  // namespace

std::optional<GroundStep> MeasureGroundStep(const SpherePyramid& image1,
                                            const SpherePyramid& image2,
                                            const Rigid3& camera1_from_camera2,
                                            const Eigen::Vector3d& up, const cv::Mat& mask,
                                            const GroundSweepOptions& options) {
  ORB360_CHECK(0 < options.min_ratio && options.min_ratio < options.max_ratio, options.min_ratio,
               options.max_ratio);
  const Eigen::Quaterniond camera2_from_camera1 = camera1_from_camera2.rotation.conjugate();
  for (const bool is_parallel : {true, false}) {
    const std::optional<Eigen::Matrix3d> axes =
        GroundAxes(camera1_from_camera2.translation, up, is_parallel);
    if (!axes) return std::nullopt;
    std::optional<GroundStep> step =
        Sweep(image1, image2, camera2_from_camera1, *axes, mask, options);
    if (!step) continue;
    const std::optional<Eigen::Matrix3d> seen = GroundAxes(step->direction, step->up, true);
    if (!seen) return std::nullopt;
    if (seen->col(2).dot(axes->col(2)) > std::cos(kMaxTilt)) return step;
    return Sweep(image1, image2, camera2_from_camera1, *seen, mask, options);
  }
  return std::nullopt;
}

}  // namespace orb360
