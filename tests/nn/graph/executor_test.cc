#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nn/base/cpu.h"
#include "tests/nn/graph/network_run.h"
#include "tests/nn/graph/node_check.h"
#include "tests/nn/graph/random_network.h"
#include "tests/nn/graph/run_times.h"
#include "tests/nn/reference_interpreter.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/executor.h>

namespace orb360::nn {
namespace {

TEST(Executor, EveryNodeOfRandomNetworksAgreesWithDoublePrecision) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(seed);
    ExpectEveryNodeRight(RandomNetwork(25, seed).Build(), RandomInputs(8, 16, seed),
                         {.threads = 2});
    if (HasFailure()) return;
  }
}

TEST(Executor, FusionAndSharedMemoryChangeNothingButRounding) {
  for (unsigned seed = 1; seed <= 120; ++seed) {
    const Graph graph = RandomNetwork(40, seed).Build();
    const std::vector<PlainImage> inputs = RandomInputs(8, 16, seed);
    const Executor fused(graph, 8, 16);
    const Executor plain(graph, 8, 16, {.keeps_tensors = true});
    EXPECT_LE(fused.planned_bytes(), plain.planned_bytes());
    const auto actual = RunOnce(fused, inputs);
    const auto expected = RunOnce(plain, inputs);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      double largest = 1;
      double worst = 0;
      for (std::size_t j = 0; j < expected[i].size(); ++j) {
        largest = std::max(largest, std::abs(static_cast<double>(expected[i][j])));
        const double error = std::abs(static_cast<double>(actual[i][j]) - expected[i][j]);
        if (!(error <= worst)) worst = error;
      }
      ASSERT_LE(worst, 1e-4 * largest) << "seed " << seed << " output " << i;
    }
  }
}

// Residual connections in every wiring that fusion may meet.
TEST(Executor, AddsWhatAConvolutionReadsOrAnotherOneWrites) {
  NetworkBuilder net;
  net.Input("image", 16);
  net.Convolution("x", "image", 16, 20, 1);
  net.Convolution("a", "x", 20, 20, 3);
  net.Node("a+x", "add", {"a", "x"});  // x is read for the last time, by both at once
  net.Convolution("b", "a+x", 20, 20, 3);
  net.Convolution("c", "a+x", 20, 20, 5);
  net.Node("b+c", "add", {"b", "c"});
  net.Node("relu", "relu", {"b+c"});
  net.Convolution("d", "relu", 20, 20, 3);
  net.Node("d+d", "add", {"d", "d"});
  net.Node("d+a", "add", {"d+d", "a+x"});
  net.Node("leaky", "leaky_relu", {"d+a"}, {{"slope", 2.5}});
  net.Output("y", "leaky");
  net.Output("z", "b+c");
  const Graph graph = net.Build();
  const std::vector<PlainImage> inputs = {RandomImage({16, 9, 11}, -1, 1, 1)};
  const auto expected = Interpret(graph, inputs);
  for (const bool keeps : {false, true}) {
    const auto outputs = RunOnce(Executor(graph, 9, 11, {.keeps_tensors = keeps}), inputs);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const std::vector<double>& should = expected.at(i == 0 ? "leaky" : "b+c").values;
      for (std::size_t j = 0; j < should.size(); ++j) {
        ASSERT_NEAR(outputs[i][j], should[j], 1e-5 * (1 + std::abs(should[j]))) << keeps << i << j;
      }
    }
  }
}

TEST(Executor, BFloat16StaysNearFloatOrIsRefused) {
  const ExecutorOptions half{.threads = 2, .precision = DataType::kBFloat16};
  if (BestBFloat16Unit() == BFloat16Unit::kNone) {
    EXPECT_THROW(Executor(RandomNetwork(20, 1).Build(), 8, 16, half), UserError);
    return;
  }
  double sum = 0;
  std::int64_t count = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Graph graph = RandomNetwork(40, seed).Build();
    const std::vector<PlainImage> inputs = RandomInputs(8, 16, seed);
    const auto expected = RunOnce(Executor(graph, 8, 16), inputs);
    const auto actual = RunOnce(Executor(graph, 8, 16, half), inputs);
    // Fusion changes where numbers are rounded to bfloat16, but not by how much.
    ExecutorOptions plain = half;
    plain.keeps_tensors = true;
    const auto unfused = RunOnce(Executor(graph, 8, 16, plain), inputs);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      double largest = 1;
      for (const float value : expected[i]) largest = std::max<double>(largest, std::abs(value));
      for (std::size_t j = 0; j < expected[i].size(); ++j) {
        // Eight bits, in up to some ten convolutions one after the other; where confidences decide
        // what is pooled, now and then another value.
        ASSERT_TRUE(std::isfinite(actual[i][j]) && std::isfinite(unfused[i][j])) << seed;
        sum += std::abs(actual[i][j] - expected[i][j]) / largest;
        sum += std::abs(unfused[i][j] - expected[i][j]) / largest;
        count += 2;
      }
    }
  }
  EXPECT_LT(sum / static_cast<double>(count), 0x1p-8);
  EXPECT_GT(sum, 0) << "nothing was rounded";
}

TEST(Executor, ThreadsDoNotChangeABit) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Graph graph = RandomNetwork(40, seed).Build();
    const std::vector<PlainImage> inputs = RandomInputs(16, 32, seed);
    EXPECT_EQ(RunOnce(Executor(graph, 16, 32, {.threads = 1}), inputs),
              RunOnce(Executor(graph, 16, 32, {.threads = 2}), inputs))
        << seed;
  }
}

TEST(Executor, RunsAreIndependentOfEachOther) {
  const Graph graph = RandomNetwork(60, 3).Build();
  const Executor executor(graph, 16, 32);
  const std::vector<PlainImage> first = RandomInputs(16, 32, 1);
  const std::vector<PlainImage> second = RandomInputs(16, 32, 2);
  const auto expected_first = RunOnce(executor, first);
  const auto expected_second = RunOnce(executor, second);
  ASSERT_NE(expected_first, expected_second);
  // One workspace after another image, and several at once.
  Executor::Workspace workspace(executor);
  for (int i = 0; i < 2; ++i) {
    NetworkRun a(executor, first);
    NetworkRun b(executor, second);
    a(executor, &workspace);
    b(executor, &workspace);
    EXPECT_EQ(a.outputs, expected_first);
    EXPECT_EQ(b.outputs, expected_second);
  }
  std::vector<std::thread> threads;
  std::vector<char> is_right(4, 0);
  for (std::size_t i = 0; i < is_right.size(); ++i) {
    threads.emplace_back([&, i] {
      bool right = true;
      for (int j = 0; j < 10; ++j) {
        right = right && RunOnce(executor, i % 2 == 0 ? first : second) ==
                             (i % 2 == 0 ? expected_first : expected_second);
      }
      is_right[i] = right;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(is_right, testing::Each(1));
}

TEST(Executor, TakesOddImagesAndSinglePixelsWhereTheGraphDoes) {
  NetworkBuilder net(1);
  net.Input("x", 3);
  net.Convolution("a", "x", 3, 20, 3, 2);
  net.Convolution("b", "a", 20, 17, 5, 2, "zero");
  net.Node("c", "leaky_relu", {"b"}, {{"slope", 0.1}});
  net.NormalizedConvolution("d", "x", "x", 3, 2, 5);
  net.Node("mean", "global_average_pool", {"c"});
  net.Dense("g", "mean", 17, 3);
  net.Output("c", "c");
  net.Output("d", "d");
  net.Output("g", "g");
  const Graph graph = net.Build();
  for (const auto& [height, width] : {std::pair{1, 1}, {1, 7}, {5, 1}, {7, 9}, {33, 35}}) {
    SCOPED_TRACE(testing::Message() << width << "x" << height);
    ExpectEveryNodeRight(graph, {RandomImage({3, height, width}, 0.1f, 1, 1)}, {.threads = 2});
  }
}

TEST(Executor, AnInputMayBeAnOutput) {
  NetworkBuilder net;
  net.Input("x", 2);
  net.Output("same", "x");
  const std::vector<PlainImage> inputs = {RandomImage({2, 3, 5}, 0, 1, 1)};
  const auto outputs = RunOnce(Executor(net.Build(), 3, 5), inputs);
  EXPECT_EQ(std::vector<double>(outputs[0].begin(), outputs[0].end()), inputs[0].values);
}

TEST(Executor, RefusesImagesOfOtherSizes) {
  const Graph graph = RandomNetwork(10, 1).Build();
  EXPECT_NO_THROW(Executor(graph, 8, 24));
  for (const auto& [height, width] : {std::pair{8, 12}, {4, 8}, {0, 8}, {-8, 8}, {8, 1 << 20}}) {
    EXPECT_THROW(Executor(graph, height, width), UserError) << width << "x" << height;
  }
}

TEST(Executor, ChecksTheSizesOfWhatItIsGiven) {
  const Graph graph = RandomNetwork(10, 1).Build();
  const Executor executor(graph, 8, 16);
  Executor::Workspace workspace(executor);
  NetworkRun good(executor, RandomInputs(8, 16, 1));
  NetworkRun run = good;
  run.inputs[0].pop_back();
  EXPECT_THROW(run(executor, &workspace), ContractError);
  run = good;
  run.inputs.pop_back();
  EXPECT_THROW(run(executor, &workspace), ContractError);
  run = good;
  run.outputs[1].push_back(0);
  EXPECT_THROW(run(executor, &workspace), ContractError);
}

TEST(Executor, MeasuresTheTimesOfAllPartsOfARun) {
  const Graph graph = RandomNetwork(40, 2).Build();
  ExpectTimesOfAllParts(graph, 64, 128, {});
  const Executor executor(graph, 64, 128);
  EXPECT_THROW(executor.Times(Executor::Workspace(executor)), ContractError);
}

TEST(Executor, RefusesAWorkspaceOfAnotherExecutor) {
  const Graph graph = RandomNetwork(10, 1).Build();
  const Executor executor(graph, 8, 16);
  const Executor other(graph, 16, 16);  // with as many steps
  Executor::Workspace workspace(other);
  EXPECT_THROW(NetworkRun(executor, RandomInputs(8, 16, 1))(executor, &workspace), ContractError);
  Executor::Workspace own(executor);
  EXPECT_NO_THROW(NetworkRun(executor, RandomInputs(8, 16, 1))(executor, &own));
}

}  // namespace
}  // namespace orb360::nn
