#include "slam/optimization/normal_equations.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/slam/optimization/noisy_walk.h"

namespace orb360 {
namespace {

constexpr int kPoses = 5;
constexpr int kPoints = 9;

/// Terms with random derivatives between random poses, some of them held, and points; also as one
/// dense system.
struct RandomTerms {
  std::array<BundleTerms, 2> terms;
  BundleLinks links;
  std::array<std::vector<TermRow>, 2> rows;
  std::array<std::vector<double>, 2> weights;
  Eigen::MatrixXd hessian;  // poses first
  Eigen::VectorXd gradient;

  explicit RandomTerms(int seed) {
    RandomGeometry random(seed);
    constexpr int kUnknowns = 6 * kPoses + 3 * kPoints;
    hessian.setZero(kUnknowns, kUnknowns);
    gradient.setZero(kUnknowns);
    std::vector<std::vector<int>> seen_by(kPoints);
    for (int point = 0; point < kPoints; ++point) {
      for (int pose = 0; pose < kPoses; ++pose) {
        // The first point is seen by poses that are held only.
        if (point > 0 && (point + pose) % 3 != 0) seen_by[point].push_back(pose);
      }
      links.pose.insert(links.pose.end(), seen_by[point].begin(), seen_by[point].end());
      links.first.push_back(links.pose.size());
    }
    for (size_t kind = 0; kind < 2; ++kind) {
      terms[kind].kind = kind == 0 ? BundleTerms::kDirection : BundleTerms::kRange;
      for (int point = 0; point < kPoints; ++point) {
        for (size_t i = 0; i <= seen_by[point].size() + 2; ++i) {
          const bool is_held = i >= seen_by[point].size();
          Add(kind, point, is_held ? -1 : static_cast<int>(links.first[point] + i), &random);
        }
      }
    }
  }

  void Add(size_t kind, int point, int link, RandomGeometry* random) {
    BundleTerms& of_kind = terms[kind];
    of_kind.point.push_back(point);
    of_kind.link.push_back(link);
    ++of_kind.size;
    const double weight = weights[kind].emplace_back(random->Uniform(0.1, 1.0));
    for (size_t i = 0; i < of_kind.num_rows(); ++i) {
      TermRow& row = rows[kind].emplace_back();
      row.by_pose.fill(0);
      for (size_t k = 0; k < 6; ++k) row.by_pose[k] = random->Normal(1.0);
      for (double& value : row.by_point) value = random->Normal(1.0);
      row.residual = random->Normal(1.0);
      Eigen::VectorXd derivative = Eigen::VectorXd::Zero(gradient.size());
      derivative.segment<3>(6 * kPoses + 3 * point) =
          Eigen::Map<const Eigen::Vector3d>(row.by_point.data());
      if (link >= 0) {
        derivative.segment<6>(6 * links.pose[static_cast<size_t>(link)]) =
            Eigen::Map<const Eigen::Matrix<double, 6, 1>>(row.by_pose.data());
      }
      hessian += weight * derivative * derivative.transpose();
      gradient += weight * row.residual * derivative;
    }
  }

  NormalEquations Equations() const {
    NormalEquations equations;
    equations.Clear(kPoses, links);
    for (size_t kind = 0; kind < 2; ++kind) {
      // In two parts, as long bundles come.
      const size_t half = terms[kind].size / 2;
      const std::span<const double> all(weights[kind]);
      const std::span<const TermRow> of_kind(rows[kind]);
      equations.Add(links, terms[kind], 0, of_kind, all.first(half));
      equations.Add(links, terms[kind], half, of_kind.subspan(half * terms[kind].num_rows()),
                    all.subspan(half));
    }
    return equations;
  }
};

TEST(NormalEquations, AreTheSumOfTheTerms) {
  const RandomTerms random(1);
  ForEachDispatchTarget([&] {
    const NormalEquations equations = random.Equations();
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(random.hessian.rows(), random.hessian.cols());
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(random.gradient.size());
    for (int i = 0; i < kPoses; ++i) {
      hessian.block<6, 6>(6 * i, 6 * i) = equations.poses[i].topRows<6>();
      gradient.segment<6>(6 * i) = equations.pose_gradients[i].head<6>();
      EXPECT_TRUE(equations.poses[i].bottomRows<2>().isZero(0));
    }
    for (int p = 0; p < kPoints; ++p) {
      const int at = 6 * kPoses + 3 * p;
      hessian.block<3, 3>(at, at) = equations.points[p];
      gradient.segment<3>(at) = equations.point_gradients[p];
      for (size_t l = random.links.first[p]; l < random.links.first[p + 1]; ++l) {
        const int pose = 6 * random.links.pose[l];
        hessian.block<6, 3>(pose, at) = equations.links[l].topRows<6>();
        hessian.block<3, 6>(at, pose) = equations.links[l].topRows<6>().transpose();
      }
    }
    EXPECT_LT((hessian - random.hessian).cwiseAbs().maxCoeff(), 1e-12 * random.hessian.norm());
    EXPECT_LT((gradient - random.gradient).cwiseAbs().maxCoeff(), 1e-12 * random.gradient.norm());
  });
}

TEST(ReducedStructure, HasThePairsThatSeeAPointInCommon) {
  // Point 0 is seen by the poses 0 and 2, point 1 by 1, 2 and 4, point 2 by 0 and 2 again; pose 3
  // sees nothing.
  const BundleLinks links{{0, 2, 1, 2, 4, 0, 2}, {0, 2, 5, 7}};
  const ReducedStructure structure(5, links);
  EXPECT_EQ(structure.num_rows(), 5u);
  EXPECT_EQ(structure.first, (std::vector<size_t>{0, 1, 2, 5, 6, 9}));
  EXPECT_EQ(structure.column, (std::vector<int>{0, 1, 0, 1, 2, 3, 1, 2, 4}));
}

TEST(ReducedStructure, KeepsPointsThatManyPosesSee) {
  const BundleLinks links{{0, 2, 1, 2, 4, 0, 2}, {0, 2, 5, 7}};
  const ReducedStructure structure(5, links, /*max_poses=*/2);
  EXPECT_EQ(structure.row_of_point, (std::vector<int>{-1, 5, -1}));
  EXPECT_EQ(structure.first, (std::vector<size_t>{0, 1, 2, 4, 5, 6, 10}));
  EXPECT_EQ(structure.column, (std::vector<int>{0, 1, 0, 2, 3, 4, 1, 2, 4, 5}));
}

TEST(EliminatePoints, LeavesTheSolutionOfTheWholeSystem) {
  const RandomTerms random(2);
  constexpr double kRadius = 3.0;
  Eigen::MatrixXd damped = random.hessian;
  const Eigen::VectorXd diagonal = random.hessian.diagonal();
  damped.diagonal() += diagonal / kRadius;
  const Eigen::VectorXd truth = damped.llt().solve(-random.gradient);
  // Points are seen by no pose that moves, by three or by four of them.
  for (const size_t max_poses : {size_t{0}, size_t{3}, ReducedStructure::kMaxPoses}) {
    ForEachDispatchTarget([&] {
      ReducedEquations reduced;
      const ReducedStructure structure(kPoses, random.links, max_poses);
      ASSERT_TRUE(EliminatePoints(random.Equations(), random.links, structure, kRadius, &reduced));
      const auto num_rows = static_cast<Eigen::Index>(structure.num_rows());
      Eigen::MatrixXd system = Eigen::MatrixXd::Zero(6 * num_rows, 6 * num_rows);
      Eigen::VectorXd sums(6 * num_rows);
      for (int i = 0; i < num_rows; ++i) {
        sums.segment<6>(6 * i) = reduced.sums[i].head<6>();
        for (size_t b = structure.first[i]; b < structure.first[i + 1]; ++b) {
          system.block<6, 6>(6 * i, 6 * structure.column[b]) = reduced.blocks[b].topRows<6>();
        }
      }
      const Eigen::VectorXd solution = system.selfadjointView<Eigen::Lower>().llt().solve(sums);
      EXPECT_LT((solution.head(6 * kPoses) - truth.head(6 * kPoses)).norm(), 1e-10 * truth.norm());
      std::vector<PoseVector> steps(structure.num_rows(), PoseVector::Zero());
      for (int i = 0; i < num_rows; ++i) steps[i].head<6>() = solution.segment<6>(6 * i);
      for (int p = 0; p < kPoints; ++p) {
        const Eigen::Vector3d step = reduced.PointStep(random.links, structure, p, steps);
        EXPECT_LT((step - truth.segment<3>(6 * kPoses + 3 * p)).norm(), 1e-10 * truth.norm()) << p;
      }
    });
  }
}

TEST(EliminatePoints, RefusesABlockThatIsNotPositiveDefinite) {
  const RandomTerms random(3);
  NormalEquations equations = random.Equations();
  equations.points[4](1, 1) = -1;
  ReducedEquations reduced;
  EXPECT_FALSE(EliminatePoints(equations, random.links, ReducedStructure(kPoses, random.links), 1.0,
                               &reduced));
}

}  // namespace
}  // namespace orb360
