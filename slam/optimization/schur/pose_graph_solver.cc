#include "slam/optimization/schur/pose_graph_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "slam/optimization/edge_residual.h"
#include "slam/optimization/schur/block_cholesky.h"
#include "slam/optimization/schur/levenberg_marquardt.h"

namespace orb360 {
namespace {

constexpr int kNodeSize = 7;  // unknowns of a similarity
using NodeBlock = PaddedBlock<kNodeSize>;
using NodeVector = Eigen::Matrix<double, kNodeSize, 1>;

// An edge with what its residual needs and where its products go. Nodes that are fixed have the
// index -1 among the free ones.
struct EdgeTerm {
  EdgeResidual residual;
  int first;
  int second;
  int free_first;
  int free_second;
  size_t block = 0;  // off-diagonal block of the two nodes, where both are free
};

// Two free nodes have a block in common where an edge links them.
BlockStructure MakeStructure(int num_free, std::vector<EdgeTerm>* terms) {
  std::vector<std::vector<int>> rows(num_free);
  for (int i = 0; i < num_free; ++i) rows[i].push_back(i);
  for (const EdgeTerm& term : *terms) {
    if (term.free_first < 0 || term.free_second < 0) continue;
    const auto [column, row] = std::minmax(term.free_first, term.free_second);
    rows[row].push_back(column);
  }
  BlockStructure structure;
  for (std::vector<int>& row : rows) {
    SortUnique(&row);
    structure.column.insert(structure.column.end(), row.begin(), row.end());
    structure.first.push_back(structure.column.size());
  }
  for (EdgeTerm& term : *terms) {
    if (term.free_first < 0 || term.free_second < 0) continue;
    const auto [column, row] = std::minmax(term.free_first, term.free_second);
    const auto index = std::ranges::lower_bound(rows[row], column) - rows[row].begin();
    term.block = structure.first[row] + static_cast<size_t>(index);
  }
  return structure;
}

// A pose graph as a Problem of MinimizeLevenbergMarquardt.
class PoseGraphMinimization {
 public:
  explicit PoseGraphMinimization(const PoseGraph& graph)
      : num_free_(NumberFreeNodes(graph)),
        terms_(MakeTerms(graph)),
        structure_(MakeStructure(num_free_, &terms_)),
        cholesky_(structure_),
        state_(graph.world_from_node.begin(), graph.world_from_node.end()) {}

  double Cost() const { return CostOf(state_); }

  void Linearize() {
    blocks_.assign(structure_.column.size(), NodeBlock::Zero());
    gradient_.assign(num_free_, NodeVector::Zero());
    EdgeResidual::Jacobian by_first;
    EdgeResidual::Jacobian by_second;
    for (const EdgeTerm& term : terms_) {
      const NodeVector error =
          term.residual(state_[term.first], state_[term.second], &by_first, &by_second);
      if (term.free_first >= 0) AddDiagonal(term.free_first, by_first, error);
      if (term.free_second >= 0) AddDiagonal(term.free_second, by_second, error);
      if (term.free_first >= 0 && term.free_second >= 0) {
        auto block = blocks_[term.block].topRows<kNodeSize>();
        if (term.free_first > term.free_second) {
          block.noalias() += by_first.transpose().lazyProduct(by_second);
        } else {
          block.noalias() += by_second.transpose().lazyProduct(by_first);
        }
      }
    }
  }

  double GradientMaxNorm() const {
    double norm = 0;
    for (const NodeVector& g : gradient_) norm = std::max(norm, g.lpNorm<Eigen::Infinity>());
    return norm;
  }

  std::optional<double> ComputeCandidate(double radius) {
    damped_ = blocks_;
    std::vector<PaddedVector> rhs(num_free_, PaddedVector::Zero());
    for (int i = 0; i < num_free_; ++i) {
      damped_[structure_.first[i + 1] - 1].diagonal() += Damping(i, radius);
      rhs[i].head<kNodeSize>() = -gradient_[i];
    }
    if (!cholesky_.Factor(damped_)) return std::nullopt;
    const std::vector<PaddedVector> solution = cholesky_.Solve(rhs);
    // Where (H + D) d = -g, the linear model's cost decreases by (D d - g) d / 2.
    double predicted = 0;
    for (int i = 0; i < num_free_; ++i) {
      const NodeVector step = solution[i].head<kNodeSize>();
      predicted += 0.5 * (Damping(i, radius).cwiseProduct(step) - gradient_[i]).dot(step);
    }
    if (!std::isfinite(predicted) || predicted <= 0) return std::nullopt;
    candidate_ = state_;
    for (size_t i = 0; i < state_.size(); ++i) {
      if (free_index_[i] >= 0) candidate_[i].Add(solution[free_index_[i]].head<kNodeSize>());
    }
    return predicted;
  }

  double CandidateCost() const { return CostOf(candidate_); }

  // Norms of the step and of the state, with rotations as quaternions.
  std::pair<double, double> StepAndStateNorms() const {
    double step = 0;
    double state = 0;
    for (size_t i = 0; i < state_.size(); ++i) {
      if (free_index_[i] < 0) continue;
      const SimilarityState& from = state_[i];
      const SimilarityState& to = candidate_[i];
      step += (to.rotation.coeffs() - from.rotation.coeffs()).squaredNorm() +
              (to.translation - from.translation).squaredNorm() +
              std::pow(to.log_scale - from.log_scale, 2);
      state += from.rotation.squaredNorm() + from.translation.squaredNorm() +
               std::pow(from.log_scale, 2);
    }
    return {std::sqrt(step), std::sqrt(state)};
  }

  void AcceptCandidate() { std::swap(state_, candidate_); }

  void Store(PoseGraph* graph) const {
    for (size_t i = 0; i < state_.size(); ++i) {
      if (free_index_[i] >= 0) graph->world_from_node[i] = state_[i].ToSimilarity();
    }
  }

 private:
  // Fills free_index_ and returns the number of nodes that are not fixed.
  int NumberFreeNodes(const PoseGraph& graph) {
    int count = 0;
    for (const uint8_t is_fixed : graph.fixed) free_index_.push_back(is_fixed ? -1 : count++);
    return count;
  }

  std::vector<EdgeTerm> MakeTerms(const PoseGraph& graph) const {
    std::vector<EdgeTerm> terms;
    terms.reserve(graph.edges.size());
    for (const PoseGraph::Edge& edge : graph.edges) {
      terms.push_back({.residual = EdgeResidual(edge, graph.unit),
                       .first = edge.first,
                       .second = edge.second,
                       .free_first = free_index_[edge.first],
                       .free_second = free_index_[edge.second]});
    }
    return terms;
  }

  double CostOf(const std::vector<SimilarityState>& state) const {
    double cost = 0;
    for (const EdgeTerm& term : terms_) {
      cost += 0.5 *
              term.residual(state[term.first], state[term.second], nullptr, nullptr).squaredNorm();
    }
    return cost;
  }

  void AddDiagonal(int node, const EdgeResidual::Jacobian& jacobian, const NodeVector& error) {
    blocks_[structure_.first[node + 1] - 1].topRows<kNodeSize>().noalias() +=
        jacobian.transpose().lazyProduct(jacobian);
    gradient_[node].noalias() += jacobian.transpose().lazyProduct(error);
  }

  NodeVector Damping(int node, double radius) const {
    const NodeVector diagonal = blocks_[structure_.first[node + 1] - 1].diagonal();
    return LevenbergMarquardtDamping(diagonal, radius);
  }

  std::vector<int> free_index_;  // by node: its index among those that are not fixed, or -1
  int num_free_;
  std::vector<EdgeTerm> terms_;
  BlockStructure structure_;
  BlockCholesky<kNodeSize> cholesky_;
  std::vector<SimilarityState> state_;
  std::vector<SimilarityState> candidate_;
  std::vector<NodeBlock> blocks_;  // of the Hessian, as the structure lists them
  std::vector<NodeBlock> damped_;
  std::vector<NodeVector> gradient_;
};

}  // namespace

SolverReport SolvePoseGraphSchur(const PoseGraphOptions& options, PoseGraph* graph) {
  PoseGraphMinimization minimization(*graph);
  const SolverReport report =
      MinimizeLevenbergMarquardt({.max_iterations = options.max_iterations,
                                  .function_tolerance = options.function_tolerance,
                                  .gradient_tolerance = options.gradient_tolerance,
                                  .parameter_tolerance = options.parameter_tolerance},
                                 &minimization);
  if (report.usable) minimization.Store(graph);
  return report;
}

}  // namespace orb360
