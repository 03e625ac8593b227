#include "slam/optimization/ceres/pose_graph_solver.h"

#include <array>
#include <cmath>
#include <vector>

#include <ceres/ceres.h>

#include "slam/optimization/ceres/solver_options.h"

namespace orb360 {
namespace {

// Parameters of a node: quaternion x y z w, translation, logarithm of the scale.
constexpr int kParameters = 8;
using Node = std::array<double, kParameters>;

Node ToNode(const Similarity3& s) {
  return {s.rotation.x(),    s.rotation.y(),    s.rotation.z(),    s.rotation.w(),
          s.translation.x(), s.translation.y(), s.translation.z(), std::log(s.scale)};
}

Similarity3 FromNode(const Node& node) {
  return {std::exp(node[7]), Eigen::Map<const Eigen::Quaterniond>(node.data()).normalized(),
          Eigen::Map<const Eigen::Vector3d>(node.data() + 4)};
}

/// The error of an edge, as SolvePoseGraph defines it. Its translation is in the second node's
/// frame and unit of length.
struct EdgeCost {
  Similarity3 second_from_first;  // as measured
  double root_weight;
  double unit;

  template <typename T>
  bool operator()(const T* first, const T* second, T* residuals) const {
    using Quaternion = Eigen::Quaternion<T>;
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Quaternion> first_rotation(first), second_rotation(second);
    const Eigen::Map<const Vector> first_translation(first + 4), second_translation(second + 4);
    const Quaternion first_from_world = first_rotation.conjugate();
    const Vector between =
        first_from_world * Vector(second_translation - first_translation) * exp(-first[7]);
    const Quaternion rotation =
        second_from_first.rotation.cast<T>() * (first_from_world * second_rotation);
    const Vector shift =
        T(second_from_first.scale) * (second_from_first.rotation.cast<T>() * between) +
        second_from_first.translation.cast<T>();
    // Twice the vector part is the rotation vector to first order. q and -q are the same rotation.
    const T factor = rotation.w() < T(0) ? T(-2.0 * root_weight) : T(2.0 * root_weight);
    Eigen::Map<Eigen::Matrix<T, 7, 1>> error(residuals);
    error.template head<3>() = factor * rotation.vec();
    error.template segment<3>(3) = T(root_weight / unit) * shift;
    error[6] = T(root_weight) * (T(std::log(second_from_first.scale)) + second[7] - first[7]);
    return true;
  }
};

}  // namespace

SolverReport SolvePoseGraphCeres(const PoseGraphOptions& options, PoseGraph* graph) {
  std::vector<Node> nodes;
  for (const Similarity3& s : graph->world_from_node) nodes.push_back(ToNode(s));
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<4>> manifold;
  ceres::Problem::Options problem_options;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  for (size_t i = 0; i < nodes.size(); ++i) {
    problem.AddParameterBlock(nodes[i].data(), kParameters, &manifold);
    if (graph->fixed[i]) problem.SetParameterBlockConstant(nodes[i].data());
  }
  for (const PoseGraph::Edge& edge : graph->edges) {
    auto* cost = new ceres::AutoDiffCostFunction<EdgeCost, 7, kParameters, kParameters>(
        new EdgeCost{edge.first_from_second.Inverse(), std::sqrt(edge.weight), graph->unit});
    problem.AddResidualBlock(cost, nullptr, nodes[edge.first].data(), nodes[edge.second].data());
  }
  ceres::Solver::Options solver_options = DeterministicSolverOptions();
  solver_options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver_options.max_num_iterations = options.max_iterations;
  solver_options.function_tolerance = options.function_tolerance;
  solver_options.gradient_tolerance = options.gradient_tolerance;
  solver_options.parameter_tolerance = options.parameter_tolerance;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);
  const SolverReport report = ToReport(summary);
  if (!report.usable) return report;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (!graph->fixed[i]) graph->world_from_node[i] = FromNode(nodes[i]);
  }
  return report;
}

}  // namespace orb360
