#include "slam/scale/shift_polynomial.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Dense>

#include "nn/base/statistics.h"

namespace orb360 {
namespace {

// A tile's shift farther from the common polynomial than this many robust standard deviations is an
// outlier.
constexpr double kMaxTileSigmas = 3.0;
// Standard deviation of the shift of a perfect tile, cells: interpolation and the tile's own
// relief.
constexpr double kTileFloor = 0.05;
// Errors of neighbouring tiles are correlated: against the truth, the errors of ln(ratio) have
// twice the standard deviation that independent tiles would give (docs/results/scale.md).
constexpr double kCorrelatedTiles = 2.0;
// Largest standard deviation of the distance between the lenses that tells anything, heights.
constexpr double kMaxLensSigma = 0.05;

constexpr int kTerms = 6;  // of a quadratic polynomial in two variables

/// A linear fit: `terms` (tiles x parameters) times `solution` are the shifts of `tiles`.
struct Fit {
  std::vector<TileShift> tiles;
  Eigen::MatrixXd terms;
  Eigen::LDLT<Eigen::MatrixXd> normal;
  Eigen::VectorXd solution;
  double scatter;  // standard deviation of a tile's shift, cells

  double SigmaOf(int parameter) const {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(terms.cols(), parameter);
    return kCorrelatedTiles * scatter * std::sqrt(normal.solve(unit)[parameter]);
  }
};

Eigen::MatrixXd TermsOf(const std::vector<TileShift>& tiles, bool with_lens_distance) {
  Eigen::MatrixXd terms(tiles.size(), with_lens_distance ? kTerms + 1 : kTerms);
  for (size_t i = 0; i < tiles.size(); ++i) {
    const double x = tiles[i].place.x();
    const double y = tiles[i].place.y();
    terms.row(i).head<kTerms>() << 1, x, y, x * x, x * y, y * y;
    if (with_lens_distance) terms(i, kTerms) = tiles[i].per_lens_distance;
  }
  return terms;
}

/// Fits, leaves out the outliers, and fits again.
std::optional<Fit> FitRobustly(std::vector<TileShift> tiles, bool with_lens_distance,
                               int min_tiles) {
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    const auto count = static_cast<Eigen::Index>(tiles.size());
    if (count < std::max(min_tiles, 2 * kTerms)) return std::nullopt;
    Eigen::MatrixXd terms = TermsOf(tiles, with_lens_distance);
    Eigen::VectorXd shifts(count);
    for (Eigen::Index i = 0; i < count; ++i) shifts[i] = tiles[i].shift;
    const Eigen::LDLT<Eigen::MatrixXd> normal((terms.transpose() * terms).eval());
    Eigen::VectorXd solution = normal.solve(terms.transpose() * shifts);
    const Eigen::VectorXd residuals = shifts - terms * solution;
    std::vector<double> absolute(count);
    for (Eigen::Index i = 0; i < count; ++i) absolute[i] = std::abs(residuals[i]);
    const double robust_sigma = std::hypot(1.4826 * Median(absolute), kTileFloor);
    const auto is_outlier = [&](const TileShift& tile) {
      return std::abs(residuals[&tile - tiles.data()]) > kMaxTileSigmas * robust_sigma;
    };
    const bool is_last = round + 1 == kRounds || std::ranges::none_of(tiles, is_outlier);
    if (is_last) {
      const double freedom = static_cast<double>(count - terms.cols());
      const double scatter = std::hypot(residuals.norm() / std::sqrt(freedom), kTileFloor);
      return Fit{std::move(tiles), std::move(terms), normal, std::move(solution), scatter};
    }
    std::vector<TileShift> kept;
    std::ranges::remove_copy_if(tiles, std::back_inserter(kept), is_outlier);
    tiles = std::move(kept);
  }
  return std::nullopt;
}

}  // namespace

std::optional<ShiftBelow> FitShifts(std::vector<TileShift> tiles, double lens_distance,
                                    int min_tiles) {
  for (TileShift& tile : tiles) tile.shift -= lens_distance * tile.per_lens_distance;
  const std::optional<Fit> fit = FitRobustly(std::move(tiles), false, min_tiles);
  if (!fit) return std::nullopt;
  Eigen::VectorXd changes(fit->terms.rows());
  for (Eigen::Index i = 0; i < changes.size(); ++i) changes[i] = -fit->tiles[i].per_lens_distance;
  return ShiftBelow{.shift = fit->solution[0],
                    .gradient = fit->solution.segment<2>(1),
                    .sigma = fit->SigmaOf(0),
                    .gradient_sigma = fit->SigmaOf(1),
                    .per_lens_distance = fit->normal.solve(fit->terms.transpose() * changes)[0],
                    .num_tiles = static_cast<int>(fit->tiles.size())};
}

LensDistance FitLensDistance(std::vector<TileShift> tiles, int min_tiles) {
  // Only what no polynomial can explain tells the distance. Without the rest, the equations are
  // well conditioned also where all tiles pass from one lens to the other.
  const auto count = static_cast<Eigen::Index>(tiles.size());
  if (count < kTerms) return {};
  const Eigen::MatrixXd terms = TermsOf(tiles, false);
  Eigen::VectorXd column(count);
  for (Eigen::Index i = 0; i < count; ++i) column[i] = tiles[i].per_lens_distance;
  column -= terms * terms.colPivHouseholderQr().solve(column);
  if (!(column.norm() > kCorrelatedTiles * kTileFloor / kMaxLensSigma)) return {};
  for (Eigen::Index i = 0; i < count; ++i) tiles[i].per_lens_distance = column[i];

  const std::optional<Fit> fit = FitRobustly(std::move(tiles), true, min_tiles);
  if (!fit) return {};
  const double sigma = fit->SigmaOf(kTerms);
  if (!(0 < sigma && sigma < kMaxLensSigma)) return {};  // also for NaN
  return {fit->solution[kTerms], sigma};
}

}  // namespace orb360
