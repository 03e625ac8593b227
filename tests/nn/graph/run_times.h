#pragma once

#include <chrono>
#include <vector>

#include <gtest/gtest.h>

#include "tests/nn/graph/network_run.h"
#include "tests/nn/graph/random_network.h"

namespace orb360::nn {

/// Runs a graph a few times and expects the times of all parts of each run, together at most what
/// the run took by the CPU's clock, and the same outputs as without times.
inline void ExpectTimesOfAllParts(const Graph& graph, int height, int width, ExecutorOptions how) {
  const std::vector<PlainImage> inputs = RandomInputs(height, width, 1);
  const std::vector<std::vector<float>> expected =
      RunOnce(Executor(graph, height, width, how), inputs);
  how.measures_times = true;
  const Executor executor(graph, height, width, how);
  Executor::Workspace workspace(executor);
  EXPECT_TRUE(executor.Times(workspace).empty());  // before a run
  NetworkRun run(executor, inputs);
  for (int i = 0; i < 3; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run(executor, &workspace);
    const std::chrono::duration<double, std::milli> passed =
        std::chrono::steady_clock::now() - start;
    const std::vector<Executor::Time> times = executor.Times(workspace);
    ASSERT_GT(times.size(), 2U);
    EXPECT_EQ(times.front().name, "inputs");
    EXPECT_EQ(times.back().name, "outputs");
    double sum = 0;
    for (const Executor::Time& time : times) {
      EXPECT_GE(time.milliseconds, 0) << time.name;
      sum += time.milliseconds;
    }
    // The clocks of CPU and device run at the same speed up to some parts in ten thousand.
    EXPECT_GT(sum, 0);
    EXPECT_LE(sum, 1.01 * passed.count());
  }
  EXPECT_EQ(run.outputs, expected);
}

}  // namespace orb360::nn
