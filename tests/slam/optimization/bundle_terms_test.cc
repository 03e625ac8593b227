#include "slam/optimization/bundle_terms.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "slam/geometry/so3.h"
#include "slam/optimization/point_residual.h"
#include "tests/dispatch_targets.h"
#include "tests/slam/optimization/noisy_walk.h"

namespace orb360 {
namespace {

BundlePlaces PlacesOf(const BundleProblem& problem) {
  BundlePlaces places;
  for (const Rigid3& world_from_camera : problem.world_from_camera) {
    const Rigid3 pose = world_from_camera.Inverse();
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      places.poses.insert(places.poses.end(),
                          {rotation(i, 0), rotation(i, 1), rotation(i, 2), pose.translation[i]});
    }
  }
  for (const Eigen::Vector3d& point : problem.points) {
    places.points.insert(places.points.end(), {point.x(), point.y(), point.z()});
  }
  return places;
}

/// The residual of a term by the functions that Ceres uses.
Eigen::Vector2d ResidualOf(const BundleProblem& problem, BundleTerms::Kind kind, size_t index,
                           const Eigen::Vector3d& seen) {
  if (kind == BundleTerms::kDirection) {
    const auto& o = problem.observations[index];
    return DirectionResidual(o.bearing, o.sigma)(seen, nullptr);
  }
  if (kind == BundleTerms::kHeight) {
    const auto& h = problem.heights[index];
    return HeightResidual(h.normal, h.height, h.sigma)(seen, nullptr);
  }
  const auto& r = problem.ranges[index];
  return RangeResidual(r.range, r.sigma)(seen, nullptr);
}

/// Evaluates all terms of a kind in blocks, as a solver does: the last one is not full.
template <typename Check>
void ForEachEvaluated(const BundleProblem& problem, const Check& check) {
  const BundlePlaces places = PlacesOf(problem);
  for (const BundleTerms& terms : MakeBundleTerms(problem)) {
    ASSERT_NE(terms.size % kMostTerms, 0) << "or the last block is full";
    constexpr size_t kBlock = 2 * kMostTerms;
    for (size_t begin = 0; begin < terms.size; begin += kBlock) {
      const size_t whole_vectors =
          (std::min(kBlock, terms.size - begin) + kMostTerms - 1) / kMostTerms * kMostTerms;
      std::vector<double> squared(whole_vectors);
      std::vector<TermRow> rows(whole_vectors * terms.num_rows());
      EvaluateTerms(terms, begin, places, squared, rows);
      std::vector<double> squared_alone(whole_vectors);
      EvaluateTerms(terms, begin, places, squared_alone, {});
      EXPECT_EQ(std::memcmp(squared.data(), squared_alone.data(), whole_vectors * sizeof(double)),
                0);
      for (size_t i = 0; i < kBlock && begin + i < terms.size; ++i) {
        check(terms, begin + i, squared[i], &rows[i * terms.num_rows()]);
      }
    }
  }
}

/// Of a size that is no multiple of any vector's.
BundleProblem OddWalk(int seed) {
  BundleProblem problem = NoisyWalk(seed);
  problem.observations.pop_back();
  problem.heights.pop_back();
  problem.ranges.pop_back();
  return problem;
}

TEST(EvaluateTerms, GivesTheResidualsOfTheirFunctions) {
  const BundleProblem problem = OddWalk(1);
  ForEachDispatchTarget([&] {
    ForEachEvaluated(problem, [&](const BundleTerms& terms, size_t t, double squared,
                                  const TermRow* rows) {
      const Eigen::Vector3d seen =
          problem.world_from_camera[terms.pose[t]].Inverse() * problem.points[terms.point[t]];
      const Eigen::Vector2d residual = ResidualOf(problem, terms.kind, t, seen);
      EXPECT_NEAR(squared, residual.squaredNorm(), 1e-9 * (1 + residual.squaredNorm()));
      for (size_t i = 0; i < terms.num_rows(); ++i) {
        EXPECT_NEAR(rows[i].residual, residual[static_cast<int>(i)], 1e-9 * (1 + residual.norm()));
      }
    });
  });
}

TEST(EvaluateTerms, GivesDerivativesThatAgreeWithFiniteDifferences) {
  const BundleProblem problem = OddWalk(2);
  constexpr double kStep = 1e-6;
  const auto expect = [&](const BundleTerms& terms, size_t t, const TermRow* rows,
                          const Eigen::Vector3d& forward, const Eigen::Vector3d& back,
                          const auto& derivative) {
    const Eigen::Vector2d difference =
        (ResidualOf(problem, terms.kind, t, forward) - ResidualOf(problem, terms.kind, t, back)) /
        (2 * kStep);
    for (size_t i = 0; i < terms.num_rows(); ++i) {
      EXPECT_NEAR(derivative(rows[i]), difference[static_cast<int>(i)],
                  1e-4 * (1 + difference.norm()));
    }
  };
  ForEachDispatchTarget([&] {
    ForEachEvaluated(problem, [&](const BundleTerms& terms, size_t t, double, const TermRow* rows) {
      const Rigid3 pose = problem.world_from_camera[terms.pose[t]].Inverse();
      const Eigen::Vector3d& point = problem.points[terms.point[t]];
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(axis);
        const auto k = static_cast<size_t>(axis);
        expect(terms, t, rows, pose * (point + d), pose * (point - d),
               [k](const TermRow& row) { return row.by_point[k]; });
        expect(terms, t, rows, ExpSo3(d) * (pose * point), ExpSo3(-d) * (pose * point),
               [k](const TermRow& row) { return row.by_pose[k]; });
        expect(terms, t, rows, pose * point + d, pose * point - d,
               [k](const TermRow& row) { return row.by_pose[3 + k]; });
      }
      for (size_t i = 0; i < terms.num_rows(); ++i) {
        EXPECT_EQ(rows[i].by_pose[6], 0);
        EXPECT_EQ(rows[i].by_pose[7], 0);
      }
    });
  });
}

TEST(EvaluateTerms, PointBeyondAllNumbersHasNoFiniteRange) {
  BundleProblem problem = OddWalk(4);
  problem.points[0] = {1e200, 0, 0};
  ForEachDispatchTarget([&] {
    ForEachEvaluated(problem,
                     [&](const BundleTerms& terms, size_t t, double squared, const TermRow*) {
                       if (terms.point[t] == 0 && terms.kind == BundleTerms::kRange) {
                         EXPECT_FALSE(std::isfinite(squared));
                       }
                     });
  });
}

TEST(EvaluateTerms, PointAtTheCameraHasNoFiniteDirectionOrRange) {
  BundleProblem problem = OddWalk(3);
  problem.points[0] = problem.world_from_camera[0].translation;
  ForEachDispatchTarget([&] {
    int found = 0;
    ForEachEvaluated(problem,
                     [&](const BundleTerms& terms, size_t t, double squared, const TermRow*) {
                       if (terms.pose[t] != 0 || terms.point[t] != 0) return;
                       ++found;
                       EXPECT_EQ(std::isfinite(squared), terms.kind == BundleTerms::kHeight);
                     });
    EXPECT_EQ(found, 3);
  });
}

}  // namespace
}  // namespace orb360
