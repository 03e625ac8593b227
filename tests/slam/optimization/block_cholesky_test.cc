#include "slam/optimization/block_cholesky.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

// A chain of poses of which each sees points with the next `reach`, and some with poses far away,
// as where a loop is closed; block by block and as one dense matrix.
struct RandomSystem {
  ReducedStructure structure;
  std::vector<PoseBlock> blocks;
  std::vector<PoseVector> sums;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;

  RandomSystem(int count, int reach, bool has_loops) {
    RandomGeometry random(count);
    matrix.setZero(6 * count, 6 * count);
    right.resize(6 * count);
    for (int i = 0; i < count; ++i) {
      PoseVector sum = PoseVector::Zero();
      for (int k = 0; k < 6; ++k) right[6 * i + k] = sum[k] = random.Normal(1.0);
      sums.push_back(sum);
      for (int j = 0; j <= i; ++j) {
        const bool is_loop = has_loops && i - j > count / 2 && j % 7 == i % 7;
        if (i - j > reach && !is_loop) continue;
        PoseBlock block = PoseBlock::Zero();
        for (int r = 0; r < 6; ++r) {
          for (int c = 0; c < 6; ++c) block(r, c) = random.Normal(1.0);
        }
        if (i == j) {
          block.topRows<6>() = (block.topRows<6>() + block.topRows<6>().transpose()).eval();
          block.diagonal().array() += 12.0 * (reach + count / 7 + 2);
        }
        structure.column.push_back(j);
        blocks.push_back(block);
        matrix.block<6, 6>(6 * i, 6 * j) = block.topRows<6>();
        matrix.block<6, 6>(6 * j, 6 * i) = block.topRows<6>().transpose();
      }
      structure.first.push_back(structure.column.size());
    }
  }
};

void ExpectSolution(const RandomSystem& system, const std::vector<PoseVector>& solution) {
  const Eigen::VectorXd truth = system.matrix.llt().solve(system.right);
  for (size_t i = 0; i < solution.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(6 * i);
    EXPECT_LT((solution[i].head<6>() - truth.segment<6>(at)).norm(), 1e-12 * truth.norm()) << i;
    EXPECT_TRUE(solution[i].tail<2>().isZero(0));
  }
}

TEST(BlockCholesky, SolvesWhatDenseFactorizationSolves) {
  for (const auto& [count, reach] :
       {std::pair{1, 0}, {2, 1}, {10, 9}, {40, 3}, {60, 50}, {90, 0}}) {
    for (const bool has_loops : {false, true}) {
      const RandomSystem system(count, reach, has_loops);
      ForEachDispatchTarget([&] {
        BlockCholesky factor(system.structure);
        ASSERT_TRUE(factor.Factor(system.blocks)) << count;
        ExpectSolution(system, factor.Solve(system.sums));
      });
    }
  }
}

TEST(BlockCholesky, FactorsOneMatrixAfterAnother) {
  RandomSystem system(30, 4, true);
  BlockCholesky factor(system.structure);
  ASSERT_TRUE(factor.Factor(system.blocks));
  for (PoseBlock& block : system.blocks) block *= 2;
  system.matrix *= 2;
  ASSERT_TRUE(factor.Factor(system.blocks));
  ExpectSolution(system, factor.Solve(system.sums));
}

TEST(BlockCholesky, KeepsFewBlocksOfALongChain) {
  const RandomSystem system(90, 3, false);
  EXPECT_LE(BlockCholesky(system.structure).size(), 90U * 4);
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefinite) {
  RandomSystem system(20, 4, false);
  system.blocks[system.structure.first[12] - 1].diagonal() *= -1;
  BlockCholesky factor(system.structure);
  EXPECT_FALSE(factor.Factor(system.blocks));
}

TEST(BlockCholesky, NothingIsSolvedByNothing) {
  BlockCholesky factor(ReducedStructure{});
  EXPECT_TRUE(factor.Factor({}));
  EXPECT_TRUE(factor.Solve({}).empty());
}

}  // namespace
}  // namespace orb360
