#include "slam/optimization/edge_residual.h"

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

PoseGraph::Edge RandomEdge(RandomGeometry* random) {
  return {.first = 0,
          .second = 1,
          .first_from_second = random->Similarity(),
          .weight = random->Uniform(0.5, 4.0)};
}

TEST(EdgeResidual, IsTheErrorOfTheMeasurement) {
  RandomGeometry random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const PoseGraph::Edge edge = RandomEdge(&random);
    const Similarity3 first = random.Similarity();
    const Eigen::Vector3d omega = random.Point(0.01, 0.3);
    const Similarity3 error{random.Uniform(0.5, 2.0), ExpSo3(omega), random.Point(0.0, 1.0)};
    const Similarity3 second = first * edge.first_from_second * error;
    const double unit = random.Uniform(0.5, 20.0);
    const EdgeResidual::Vector residual =
        EdgeResidual(edge, unit)(SimilarityState(first), SimilarityState(second), nullptr, nullptr);
    const double root_weight = std::sqrt(edge.weight);
    EXPECT_LT(
        (residual.head<3>() - root_weight * 2 * std::sin(omega.norm() / 2) / omega.norm() * omega)
            .norm(),
        1e-12);
    EXPECT_LT((residual.segment<3>(3) - root_weight / unit * error.translation).norm(), 1e-10);
    EXPECT_NEAR(residual[6], root_weight * std::log(error.scale), 1e-12);
  }
}

TEST(EdgeResidual, ItsJacobiansAgreeWithFiniteDifferences) {
  RandomGeometry random(2);
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 200; ++trial) {
    const EdgeResidual residual(RandomEdge(&random), random.Uniform(0.5, 20.0));
    const SimilarityState states[] = {SimilarityState(random.Similarity()),
                                      SimilarityState(random.Similarity())};
    EdgeResidual::Jacobian jacobians[2];
    residual(states[0], states[1], &jacobians[0], &jacobians[1]);
    for (int node = 0; node < 2; ++node) {
      for (int i = 0; i < 7; ++i) {
        SimilarityState forward[] = {states[0], states[1]};
        SimilarityState back[] = {states[0], states[1]};
        forward[node].Add(kStep * EdgeResidual::Vector::Unit(i));
        back[node].Add(-kStep * EdgeResidual::Vector::Unit(i));
        const EdgeResidual::Vector numeric = (residual(forward[0], forward[1], nullptr, nullptr) -
                                              residual(back[0], back[1], nullptr, nullptr)) /
                                             (2 * kStep);
        EXPECT_LT((numeric - jacobians[node].col(i)).norm(), 1e-6 * (1 + numeric.norm()))
            << node << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace orb360
