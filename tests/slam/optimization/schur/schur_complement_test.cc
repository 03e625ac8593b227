#include "slam/optimization/schur/schur_complement.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/optimization/schur/random_blocks.h"

namespace orb360 {
namespace {

constexpr int kPoses = RandomBlocks::kPoses;
constexpr int kPoints = RandomBlocks::kPoints;

TEST(ReducedCameraStructure, HasThePairsThatSeeAPointInCommon) {
  // Point 0 is seen by the poses 0 and 2, point 1 by 1, 2 and 4, point 2 by 0 and 2 again; pose 3
  // sees nothing.
  const PosePointPairs pairs{{0, 2, 1, 2, 4, 0, 2}, {0, 2, 5, 7}};
  const ReducedCameraStructure structure(5, pairs);
  EXPECT_EQ(structure.num_rows(), 5u);
  EXPECT_EQ(structure.first, (std::vector<size_t>{0, 1, 2, 5, 6, 9}));
  EXPECT_EQ(structure.column, (std::vector<int>{0, 1, 0, 1, 2, 3, 1, 2, 4}));
}

TEST(ReducedCameraStructure, KeepsPointsThatManyPosesSee) {
  const PosePointPairs pairs{{0, 2, 1, 2, 4, 0, 2}, {0, 2, 5, 7}};
  const ReducedCameraStructure structure(5, pairs, /*max_poses=*/2);
  EXPECT_EQ(structure.row_of_point, (std::vector<int>{-1, 5, -1}));
  EXPECT_EQ(structure.first, (std::vector<size_t>{0, 1, 2, 4, 5, 6, 10}));
  EXPECT_EQ(structure.column, (std::vector<int>{0, 1, 0, 2, 3, 4, 1, 2, 4, 5}));
}

TEST(EliminatePoints, LeavesTheSolutionOfTheWholeSystem) {
  const RandomBlocks random(2);
  constexpr double kRadius = 3.0;
  Eigen::MatrixXd damped = random.hessian;
  const Eigen::VectorXd diagonal = random.hessian.diagonal();
  damped.diagonal() += diagonal / kRadius;
  const Eigen::VectorXd truth = damped.llt().solve(-random.gradient);
  // Points are seen by zero, three or four poses that are not fixed.
  for (const size_t max_poses : {size_t{0}, size_t{3}, ReducedCameraStructure::kMaxPoses}) {
    ForEachDispatchTarget([&] {
      ReducedCameraSystem reduced;
      const ReducedCameraStructure structure(kPoses, random.pairs, max_poses);
      ASSERT_TRUE(EliminatePoints(random.Equations(), random.pairs, structure, kRadius, &reduced));
      const auto num_rows = static_cast<Eigen::Index>(structure.num_rows());
      Eigen::MatrixXd system = Eigen::MatrixXd::Zero(6 * num_rows, 6 * num_rows);
      Eigen::VectorXd rhs(6 * num_rows);
      for (int i = 0; i < num_rows; ++i) {
        rhs.segment<6>(6 * i) = reduced.rhs[i].head<6>();
        for (size_t b = structure.first[i]; b < structure.first[i + 1]; ++b) {
          system.block<6, 6>(6 * i, 6 * structure.column[b]) = reduced.blocks[b].topRows<6>();
        }
      }
      const Eigen::VectorXd solution = system.selfadjointView<Eigen::Lower>().llt().solve(rhs);
      EXPECT_LT((solution.head(6 * kPoses) - truth.head(6 * kPoses)).norm(), 1e-10 * truth.norm());
      std::vector<PaddedVector> steps(structure.num_rows(), PaddedVector::Zero());
      for (int i = 0; i < num_rows; ++i) steps[i].head<6>() = solution.segment<6>(6 * i);
      for (int p = 0; p < kPoints; ++p) {
        const Eigen::Vector3d step = reduced.BackSubstitute(random.pairs, structure, p, steps);
        EXPECT_LT((step - truth.segment<3>(6 * kPoses + 3 * p)).norm(), 1e-10 * truth.norm()) << p;
      }
    });
  }
}

TEST(EliminatePoints, RefusesABlockThatIsNotPositiveDefinite) {
  const RandomBlocks random(3);
  NormalEquations equations = random.Equations();
  equations.point_hessian[4](1, 1) = -1;
  ReducedCameraSystem reduced;
  EXPECT_FALSE(EliminatePoints(equations, random.pairs,
                               ReducedCameraStructure(kPoses, random.pairs), 1.0, &reduced));
}

}  // namespace
}  // namespace orb360
