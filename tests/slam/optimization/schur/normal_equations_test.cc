#include "slam/optimization/schur/normal_equations.h"

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/optimization/schur/random_blocks.h"

namespace orb360 {
namespace {

constexpr int kPoses = RandomBlocks::kPoses;
constexpr int kPoints = RandomBlocks::kPoints;

TEST(NormalEquations, AreTheSumOverTheResidualBlocks) {
  const RandomBlocks random(1);
  ForEachDispatchTarget([&] {
    const NormalEquations equations = random.Equations();
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(random.hessian.rows(), random.hessian.cols());
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(random.gradient.size());
    for (int i = 0; i < kPoses; ++i) {
      hessian.block<6, 6>(6 * i, 6 * i) = equations.pose_hessian[i].topRows<6>();
      gradient.segment<6>(6 * i) = equations.pose_gradient[i].head<6>();
      EXPECT_TRUE(equations.pose_hessian[i].bottomRows<2>().isZero(0));
    }
    for (int p = 0; p < kPoints; ++p) {
      const int at = 6 * kPoses + 3 * p;
      hessian.block<3, 3>(at, at) = equations.point_hessian[p];
      gradient.segment<3>(at) = equations.point_gradient[p];
      for (size_t l = random.pairs.first[p]; l < random.pairs.first[p + 1]; ++l) {
        const int pose = 6 * random.pairs.pose[l];
        hessian.block<6, 3>(pose, at) = equations.pair_hessian[l].topRows<6>();
        hessian.block<3, 6>(at, pose) = equations.pair_hessian[l].topRows<6>().transpose();
      }
    }
    EXPECT_LT((hessian - random.hessian).cwiseAbs().maxCoeff(), 1e-12 * random.hessian.norm());
    EXPECT_LT((gradient - random.gradient).cwiseAbs().maxCoeff(), 1e-12 * random.gradient.norm());
  });
}

}  // namespace
}  // namespace orb360
