#include "slam/optimization/schur/block_cholesky.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

// A chain of variables of which each has blocks in common with the next `reach`, and some with
// variables far away, as where a loop is closed: by blocks and as one dense matrix.
template <int kSize>
struct RandomSystem {
  BlockStructure structure;
  std::vector<PaddedBlock<kSize>> blocks;
  std::vector<PaddedVector> rhs;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd dense_rhs;

  RandomSystem(int count, int reach, bool has_loops) {
    RandomGeometry random(count);
    matrix.setZero(kSize * count, kSize * count);
    dense_rhs.resize(kSize * count);
    for (int i = 0; i < count; ++i) {
      PaddedVector& vector = rhs.emplace_back(PaddedVector::Zero());
      for (int k = 0; k < kSize; ++k) dense_rhs[kSize * i + k] = vector[k] = random.Normal(1.0);
      for (int j = 0; j <= i; ++j) {
        const bool is_loop = has_loops && i - j > count / 2 && j % 7 == i % 7;
        if (i - j > reach && !is_loop) continue;
        Eigen::Matrix<double, kSize, kSize> block;
        for (double& value : block.reshaped()) value = random.Normal(1.0);
        if (i == j) {
          block = (block + block.transpose()).eval();
          block.diagonal().array() += 14.0 * (reach + count / 7 + 2);
        }
        structure.column.push_back(j);
        blocks.emplace_back(PaddedBlock<kSize>::Zero()).template topRows<kSize>() = block;
        matrix.block<kSize, kSize>(kSize * i, kSize * j) = block;
        matrix.block<kSize, kSize>(kSize * j, kSize * i) = block.transpose();
      }
      structure.first.push_back(structure.column.size());
    }
  }
};

template <int kSize>
void ExpectSolution(const RandomSystem<kSize>& system, const std::vector<PaddedVector>& solution) {
  const Eigen::VectorXd truth = system.matrix.llt().solve(system.dense_rhs);
  ASSERT_EQ(solution.size(), system.structure.num_rows());
  for (size_t i = 0; i < solution.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(kSize * i);
    EXPECT_LT((solution[i].head<kSize>() - truth.segment<kSize>(at)).norm(), 1e-12 * truth.norm())
        << i;
    EXPECT_TRUE(solution[i].tail<kPaddedRows - kSize>().isZero(0));
  }
}

template <typename Size>
class BlockCholeskyTest : public testing::Test {};
using Sizes = testing::Types<std::integral_constant<int, 6>, std::integral_constant<int, 7>>;
TYPED_TEST_SUITE(BlockCholeskyTest, Sizes);

TYPED_TEST(BlockCholeskyTest, SolvesWhatDenseFactorizationSolves) {
  for (const auto& [count, reach] :
       {std::pair{1, 0}, {2, 1}, {10, 9}, {40, 3}, {60, 50}, {90, 0}}) {
    for (const bool has_loops : {false, true}) {
      const RandomSystem<TypeParam::value> system(count, reach, has_loops);
      ForEachDispatchTarget([&, num_rows = count] {
        BlockCholesky<TypeParam::value> cholesky(system.structure);
        ASSERT_TRUE(cholesky.Factor(system.blocks)) << num_rows;
        ExpectSolution(system, cholesky.Solve(system.rhs));
      });
    }
  }
}

TYPED_TEST(BlockCholeskyTest, FactorsOneMatrixAfterAnother) {
  RandomSystem<TypeParam::value> system(30, 4, true);
  BlockCholesky<TypeParam::value> cholesky(system.structure);
  ASSERT_TRUE(cholesky.Factor(system.blocks));
  for (auto& block : system.blocks) block *= 2;
  system.matrix *= 2;
  ASSERT_TRUE(cholesky.Factor(system.blocks));
  ExpectSolution(system, cholesky.Solve(system.rhs));
}

TYPED_TEST(BlockCholeskyTest, StoresFewBlocksOfALongChain) {
  const RandomSystem<TypeParam::value> system(90, 3, false);
  EXPECT_LE(BlockCholesky<TypeParam::value>(system.structure).size(), 90U * 4);
}

TYPED_TEST(BlockCholeskyTest, RefusesAMatrixThatIsNotPositiveDefinite) {
  RandomSystem<TypeParam::value> system(20, 4, false);
  system.blocks[system.structure.first[12] - 1].diagonal() *= -1;
  BlockCholesky<TypeParam::value> cholesky(system.structure);
  EXPECT_FALSE(cholesky.Factor(system.blocks));
}

TYPED_TEST(BlockCholeskyTest, SolvesTheEmptySystem) {
  BlockCholesky<TypeParam::value> cholesky(BlockStructure{});
  EXPECT_TRUE(cholesky.Factor({}));
  EXPECT_TRUE(cholesky.Solve({}).empty());
}

}  // namespace
}  // namespace orb360
