#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/optimization/schur/normal_equations.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {

/// Residual blocks with random Jacobians between poses, some of them fixed, and points, also as one
/// dense system.
struct RandomBlocks {
  static constexpr int kPoses = 5;
  static constexpr int kPoints = 9;

  std::array<ResidualBlocks, 2> blocks;
  PosePointPairs pairs;
  std::array<std::vector<JacobianRow>, 2> rows;
  std::array<std::vector<double>, 2> weights;
  Eigen::MatrixXd hessian;  // poses first
  Eigen::VectorXd gradient;

  explicit RandomBlocks(int seed) {
    RandomGeometry random(seed);
    constexpr int kUnknowns = 6 * kPoses + 3 * kPoints;
    hessian.setZero(kUnknowns, kUnknowns);
    gradient.setZero(kUnknowns);
    std::vector<std::vector<int>> seen_by(kPoints);
    for (int point = 0; point < kPoints; ++point) {
      for (int pose = 0; pose < kPoses; ++pose) {
        // Only fixed poses see the first point.
        if (point > 0 && (point + pose) % 3 != 0) seen_by[point].push_back(pose);
      }
      pairs.pose.insert(pairs.pose.end(), seen_by[point].begin(), seen_by[point].end());
      pairs.first.push_back(pairs.pose.size());
    }
    for (size_t kind = 0; kind < 2; ++kind) {
      blocks[kind].kind = kind == 0 ? ResidualBlocks::kDirection : ResidualBlocks::kRange;
      for (int point = 0; point < kPoints; ++point) {
        for (size_t i = 0; i <= seen_by[point].size() + 2; ++i) {
          const bool is_fixed = i >= seen_by[point].size();
          Add(kind, point, is_fixed ? -1 : static_cast<int>(pairs.first[point] + i), &random);
        }
      }
    }
  }

  void Add(size_t kind, int point, int pair, RandomGeometry* random) {
    ResidualBlocks& of_kind = blocks[kind];
    of_kind.point.push_back(point);
    of_kind.pair.push_back(pair);
    ++of_kind.size;
    const double weight = weights[kind].emplace_back(random->Uniform(0.1, 1.0));
    for (size_t i = 0; i < of_kind.num_rows(); ++i) {
      JacobianRow& row = rows[kind].emplace_back();
      row.by_pose.fill(0);
      for (size_t k = 0; k < 6; ++k) row.by_pose[k] = random->Normal(1.0);
      for (double& value : row.by_point) value = random->Normal(1.0);
      row.residual = random->Normal(1.0);
      Eigen::VectorXd derivative = Eigen::VectorXd::Zero(gradient.size());
      derivative.segment<3>(6 * kPoses + 3 * point) =
          Eigen::Map<const Eigen::Vector3d>(row.by_point.data());
      if (pair >= 0) {
        derivative.segment<6>(6 * pairs.pose[static_cast<size_t>(pair)]) =
            Eigen::Map<const Eigen::Matrix<double, 6, 1>>(row.by_pose.data());
      }
      hessian += weight * derivative * derivative.transpose();
      gradient += weight * row.residual * derivative;
    }
  }

  NormalEquations Equations() const {
    NormalEquations equations;
    equations.SetZero(kPoses, pairs);
    for (size_t kind = 0; kind < 2; ++kind) {
      // In two batches, as the evaluator does it.
      const size_t half = blocks[kind].size / 2;
      const std::span<const double> all(weights[kind]);
      const std::span<const JacobianRow> of_kind(rows[kind]);
      equations.Accumulate(pairs, blocks[kind], 0, of_kind, all.first(half));
      equations.Accumulate(pairs, blocks[kind], half,
                           of_kind.subspan(half * blocks[kind].num_rows()), all.subspan(half));
    }
    return equations;
  }
};

}  // namespace orb360
