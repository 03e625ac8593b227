#include "slam/optimization/schur/residual_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "slam/optimization/point_residual.h"
#include "tests/dispatch_targets.h"
#include "tests/slam/optimization/noisy_walk.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

PackedState Pack(const BundleProblem& problem) {
  PackedState packed;
  for (const Rigid3& world_from_camera : problem.world_from_camera) {
    const Rigid3 pose = world_from_camera.Inverse();
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      packed.poses.insert(packed.poses.end(),
                          {rotation(i, 0), rotation(i, 1), rotation(i, 2), pose.translation[i]});
    }
  }
  for (const Eigen::Vector3d& point : problem.points) {
    packed.points.insert(packed.points.end(), {point.x(), point.y(), point.z()});
  }
  return packed;
}

/// The residual of a block by the functions that Ceres uses.
Eigen::Vector2d ResidualOf(const BundleProblem& problem, ResidualBlocks::Kind kind, size_t index,
                           const Eigen::Vector3d& seen) {
  if (kind == ResidualBlocks::kDirection) {
    const auto& o = problem.observations[index];
    return DirectionResidual(o.bearing, o.sigma)(seen, nullptr);
  }
  if (kind == ResidualBlocks::kHeight) {
    const auto& h = problem.heights[index];
    return HeightResidual(h.normal, h.height, h.sigma)(seen, nullptr);
  }
  const auto& r = problem.ranges[index];
  return RangeResidual(r.range, r.sigma)(seen, nullptr);
}

/// Evaluates all blocks of a kind in blocks, as a solver does: the last one is not full.
template <typename Check>
void ForEachEvaluated(const BundleProblem& problem, const Check& check) {
  const PackedState packed = Pack(problem);
  for (const ResidualBlocks& blocks : MakeResidualBlocks(problem)) {
    ASSERT_NE(blocks.size % kMaxLanes, 0) << "or the last block is full";
    constexpr size_t kBlock = 2 * kMaxLanes;
    for (size_t begin = 0; begin < blocks.size; begin += kBlock) {
      const size_t whole_vectors =
          (std::min(kBlock, blocks.size - begin) + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
      std::vector<double> squared(whole_vectors);
      std::vector<JacobianRow> rows(whole_vectors * blocks.num_rows());
      EvaluateResidualBlocks(blocks, begin, packed, squared, rows);
      std::vector<double> squared_alone(whole_vectors);
      EvaluateResidualBlocks(blocks, begin, packed, squared_alone, {});
      EXPECT_EQ(std::memcmp(squared.data(), squared_alone.data(), whole_vectors * sizeof(double)),
                0);
      for (size_t i = 0; i < kBlock && begin + i < blocks.size; ++i) {
        check(blocks, begin + i, squared[i], &rows[i * blocks.num_rows()]);
      }
    }
  }
}

/// A walk whose numbers of residual blocks are not multiples of the length of any vector.
BundleProblem OddWalk(int seed) {
  BundleProblem problem = NoisyWalk(seed);
  problem.observations.pop_back();
  problem.heights.pop_back();
  problem.ranges.pop_back();
  return problem;
}

TEST(EvaluateResidualBlocks, GivesTheResidualsOfTheirFunctions) {
  const BundleProblem problem = OddWalk(1);
  ForEachDispatchTarget([&] {
    ForEachEvaluated(problem, [&](const ResidualBlocks& blocks, size_t t, double squared,
                                  const JacobianRow* rows) {
      const Eigen::Vector3d seen =
          problem.world_from_camera[blocks.pose[t]].Inverse() * problem.points[blocks.point[t]];
      const Eigen::Vector2d residual = ResidualOf(problem, blocks.kind, t, seen);
      EXPECT_NEAR(squared, residual.squaredNorm(), 1e-9 * (1 + residual.squaredNorm()));
      for (size_t i = 0; i < blocks.num_rows(); ++i) {
        EXPECT_NEAR(rows[i].residual, residual[static_cast<int>(i)], 1e-9 * (1 + residual.norm()));
      }
    });
  });
}

TEST(EvaluateResidualBlocks, GivesDerivativesThatAgreeWithFiniteDifferences) {
  const BundleProblem problem = OddWalk(2);
  constexpr double kStep = 1e-6;
  const auto expect = [&](const ResidualBlocks& blocks, size_t t, const JacobianRow* rows,
                          const Eigen::Vector3d& forward, const Eigen::Vector3d& back,
                          const auto& derivative) {
    const Eigen::Vector2d difference =
        (ResidualOf(problem, blocks.kind, t, forward) - ResidualOf(problem, blocks.kind, t, back)) /
        (2 * kStep);
    for (size_t i = 0; i < blocks.num_rows(); ++i) {
      EXPECT_NEAR(derivative(rows[i]), difference[static_cast<int>(i)],
                  1e-4 * (1 + difference.norm()));
    }
  };
  ForEachDispatchTarget([&] {
    ForEachEvaluated(
        problem, [&](const ResidualBlocks& blocks, size_t t, double, const JacobianRow* rows) {
          const Rigid3 pose = problem.world_from_camera[blocks.pose[t]].Inverse();
          const Eigen::Vector3d& point = problem.points[blocks.point[t]];
          for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(axis);
            const auto k = static_cast<size_t>(axis);
            expect(blocks, t, rows, pose * (point + d), pose * (point - d),
                   [k](const JacobianRow& row) { return row.by_point[k]; });
            expect(blocks, t, rows, ExpSo3(d) * (pose * point), ExpSo3(-d) * (pose * point),
                   [k](const JacobianRow& row) { return row.by_pose[k]; });
            expect(blocks, t, rows, pose * point + d, pose * point - d,
                   [k](const JacobianRow& row) { return row.by_pose[3 + k]; });
          }
          for (size_t i = 0; i < blocks.num_rows(); ++i) {
            EXPECT_EQ(rows[i].by_pose[6], 0);
            EXPECT_EQ(rows[i].by_pose[7], 0);
          }
        });
  });
}

TEST(EvaluateResidualBlocks, PointBeyondAllNumbersHasNoFiniteRange) {
  BundleProblem problem = OddWalk(4);
  problem.points[0] = {1e200, 0, 0};
  ForEachDispatchTarget([&] {
    ForEachEvaluated(
        problem, [&](const ResidualBlocks& blocks, size_t t, double squared, const JacobianRow*) {
          if (blocks.point[t] == 0 && blocks.kind == ResidualBlocks::kRange) {
            EXPECT_FALSE(std::isfinite(squared));
          }
        });
  });
}

TEST(EvaluateResidualBlocks, PointAtTheCameraHasNoFiniteDirectionOrRange) {
  BundleProblem problem = OddWalk(3);
  problem.points[0] = problem.world_from_camera[0].translation;
  ForEachDispatchTarget([&] {
    int found = 0;
    ForEachEvaluated(
        problem, [&](const ResidualBlocks& blocks, size_t t, double squared, const JacobianRow*) {
          if (blocks.pose[t] != 0 || blocks.point[t] != 0) return;
          ++found;
          EXPECT_EQ(std::isfinite(squared), blocks.kind == ResidualBlocks::kHeight);
        });
    EXPECT_EQ(found, 3);
  });
}

}  // namespace
}  // namespace orb360
