#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "slam/optimization/bundle_adjustment.h"

namespace orb360 {

/// Terms that vector instructions may take at once.
inline constexpr size_t kMostTerms = 8;

/// A row of a term's residual with its derivatives, for vector instructions.
struct TermRow {
  /// By the pose, as six numbers filled up with zeros: see BundleEstimate.
  std::array<double, 8> by_pose;
  std::array<double, 3> by_point;
  double residual;
};

/// Where cameras and points are, for vector instructions.
struct BundlePlaces {
  std::vector<double> poses;   // camera from world: [R t] by rows, 12 numbers each
  std::vector<double> points;  // three each
};

/// The residuals of one kind (see point_residual.h) of a bundle, one in each place of the columns.
struct BundleTerms {
  enum Kind { kDirection, kHeight, kRange };
  static constexpr size_t kMostColumns = 6;

  Kind kind = kDirection;
  size_t size = 0;
  std::vector<int> pose;
  std::vector<int> point;
  std::vector<int> link;  // see BundleLinks; -1 where the pose is held
  /// What is known, filled up to a multiple of kMostTerms; by kind: the scaled basis of the
  /// direction's tangent plane; direction and offset of the height; logarithm and weight of the
  /// range.
  std::array<std::vector<double>, kMostColumns> known;

  size_t num_rows() const { return kind == kDirection ? 2 : 1; }
};

/// Each kind once; links are -1.
std::array<BundleTerms, 3> MakeBundleTerms(const BundleProblem& problem);

/// Squared residuals of the terms from `begin`, a multiple of kMostTerms, on; not finite where
/// there is none. `rows`, unless empty, are filled as well, each term's together. There is room
/// for whole vectors: `squared` is a multiple of kMostTerms long, and reaches past the last term by
/// less than that.
void EvaluateTerms(const BundleTerms& terms, size_t begin, const BundlePlaces& places,
                   std::span<double> squared, std::span<TermRow> rows);

}  // namespace orb360
