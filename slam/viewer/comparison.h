#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "slam/evaluation/trajectory_error.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// A path with which that of a run is compared.
struct ComparedPath {
  std::string name;       ///< As the user named it.
  bool is_truth = false;  ///< Ground truth, or another file of poses, and not another run.
  bool has_metres = true;
  std::vector<StampedPose> poses;  ///< In the order of time, in a world of their own.
};

/// What the other path shows of the run's.
struct Comparison {
  ComparedPath other;
  /// Both are in metres and a rigid motion aligns them. Otherwise the similarity has a scale of its
  /// own.
  bool is_rigid = false;
  Similarity3 run_from_other;
  bool has_metres = false;  ///< Errors are in metres; otherwise in units of the run.
  struct Error {
    double timestamp = 0;  ///< Of the run's frame, seconds.
    double distance = 0;   ///< Between the two positions after the alignment.
  };
  std::vector<Error> errors;   ///< In the order of time.
  ErrorStatistics statistics;  ///< Of `errors`; `rmse` is the absolute trajectory error.
};

/// Aligns the positions of a run and of another path at the times that they have in common, within
/// 20 ms, such that the sum of squared distances is least (AlignRigid, AlignSimilarity): the
/// distances in the world of the other path where that has metres, otherwise in that of the run.
/// None where fewer than three poses have a time in common, or all of them are in one place.
std::optional<Comparison> ComparePaths(std::span<const StampedPose> run, bool has_metres,
                                       const ComparedPath& other);

/// The part `comparison` of the page's `run.json`.
///
/// | key | meaning |
/// |---|---|
/// | `name`, `isTruth`, `isRigid` | as above |
/// | `scale`, `rotation`, `translation` | of run_from_other; the rotation as x y z w |
/// | `path` | positions of the other path in the world of the run, 3 numbers each |
/// | `unit` | `m` or `units`, of what follows |
/// | `time`, `error` | of the frames that have a counterpart |
/// | `rmse`, `mean`, `median`, `max` | of `error` |
nlohmann::json ComparisonJson(const Comparison& comparison);

}  // namespace orb360
