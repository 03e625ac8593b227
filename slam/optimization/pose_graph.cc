#include "slam/optimization/pose_graph.h"

#include <array>
#include <cmath>

#include <ceres/ceres.h>

#include "nn/base/check.h"

namespace orb360 {
namespace {

// Of a node's parameters: quaternion x y z w, translation, logarithm of the scale.
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

/// Error of second_from_first * first_from_second: turn, translation (in the units of the second
/// node) and logarithm of the scale.
struct EdgeCost {
  Similarity3 second_from_first;  // as measured
  double root_weight;
  double unit;

  template <typename T>
  bool operator()(const T* first, const T* second, T* residuals) const {
    using Quaternion = Eigen::Quaternion<T>;
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Quaternion> first_rotation(first), second_rotation(second);
    const Eigen::Map<const Vector> first_place(first + 4), second_place(second + 4);
    const Quaternion first_from_world = first_rotation.conjugate();
    const Vector between = first_from_world * Vector(second_place - first_place) * exp(-first[7]);
    const Quaternion turn =
        second_from_first.rotation.cast<T>() * (first_from_world * second_rotation);
    const Vector shift =
        T(second_from_first.scale) * (second_from_first.rotation.cast<T>() * between) +
        second_from_first.translation.cast<T>();
    // Twice the vector part is the turn's angle; q and -q are the same turn.
    const T side = turn.w() < T(0) ? T(-2.0 * root_weight) : T(2.0 * root_weight);
    Eigen::Map<Eigen::Matrix<T, 7, 1>> error(residuals);
    error.template head<3>() = side * turn.vec();
    error.template segment<3>(3) = T(root_weight / unit) * shift;
    error[6] = T(root_weight) * (T(std::log(second_from_first.scale)) + second[7] - first[7]);
    return true;
  }
};

}  // namespace

bool SolvePoseGraph(PoseGraph* graph) {
  ORB360_CHECK(graph->fixed.size() == graph->world_from_node.size());
  ORB360_CHECK(graph->unit > 0, graph->unit);
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
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = 30;
  options.max_solver_time_in_seconds = 1e9;  // a limit would make results depend on load
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return false;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (!graph->fixed[i]) graph->world_from_node[i] = FromNode(nodes[i]);
  }
  return true;
}

}  // namespace orb360
