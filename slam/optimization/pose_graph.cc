#include "slam/optimization/pose_graph.h"

#include "slam/optimization/ceres/pose_graph_solver.h"
#include "slam/optimization/schur/pose_graph_solver.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

SolverReport SolvePoseGraph(const PoseGraphOptions& options, PoseGraph* graph) {
  ORB360_CHECK(graph->fixed.size() == graph->world_from_node.size());
  ORB360_CHECK(graph->unit > 0, graph->unit);
  return options.optimizer == Optimizer::kCeres ? SolvePoseGraphCeres(options, graph)
                                                : SolvePoseGraphSchur(options, graph);
}

}  // namespace orb360
