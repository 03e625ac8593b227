#include "nn/graph/memory_plan.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nn/graph/buffer_assignment.h"
#include "nn/graph/cpu_backend.h"
#include "nn/graph/cpu_program.h"
#include "tests/nn/graph/random_network.h"
#include <orb360/nn/tensor.h>

namespace orb360::nn {
namespace {

void ExpectNoOverlap(const std::vector<Lifetime>& pieces, const std::vector<std::size_t>& offsets,
                     std::size_t bytes) {
  ASSERT_EQ(offsets.size(), pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    ASSERT_EQ(offsets[i] % kAlignment, 0u);
    ASSERT_LE(offsets[i] + pieces[i].bytes, bytes);
    for (std::size_t j = 0; j < i; ++j) {
      const bool meet = pieces[i].first <= pieces[j].last && pieces[j].first <= pieces[i].last;
      const bool overlap =
          offsets[i] < offsets[j] + pieces[j].bytes && offsets[j] < offsets[i] + pieces[i].bytes;
      ASSERT_FALSE(meet && overlap) << i << ' ' << j;
    }
  }
}

// What is needed at the same time, at its most: no plan is smaller.
std::size_t LeastBytes(const std::vector<Lifetime>& pieces) {
  std::size_t most = 0;
  for (const Lifetime& moment : pieces) {
    std::size_t bytes = 0;
    for (const Lifetime& piece : pieces) {
      if (piece.first <= moment.first && moment.first <= piece.last) bytes += piece.bytes;
    }
    most = std::max(most, bytes);
  }
  return most;
}

TEST(MemoryPlan, PiecesNeededTogetherNeverOverlap) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    std::vector<Lifetime> pieces(random() % 60);
    for (Lifetime& piece : pieces) {
      piece.bytes = random() % 5000;
      piece.first = static_cast<int>(random() % 40);
      piece.last = piece.first + static_cast<int>(random() % 10);
    }
    const MemoryPlan plan = PlanMemory(pieces);
    ExpectNoOverlap(pieces, plan.offsets, plan.bytes);
    if (HasFatalFailure()) return;
  }
}

TEST(MemoryPlan, AChainNeedsTwoPieces) {
  std::vector<Lifetime> chain;
  for (int i = 0; i < 10; ++i) chain.push_back({6400, i, i + 1});
  EXPECT_EQ(PlanMemory(chain).bytes, 2u * 6400);
}

TEST(MemoryPlan, FillsGaps) {
  // The second leaves a gap during step 1 in which the fourth has room.
  EXPECT_EQ(
      PlanMemory(std::vector<Lifetime>{{1280, 0, 1}, {640, 0, 0}, {512, 0, 1}, {128, 1, 1}}).bytes,
      1280u + 640 + 512);
}

TEST(MemoryPlan, NothingNeedsNothing) { EXPECT_EQ(PlanMemory({}).bytes, 0u); }

TEST(MemoryPlan, TensorsOfRandomNetworksNeverOverlap) {
  const CpuBackend backend(1);
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Graph graph = RandomNetwork(50, seed).Build();
    const std::vector<FusedNode> nodes = FuseNodes(graph);
    const Lowered lowered = Lower(graph, nodes, backend, 16, 32);
    const std::vector<Step> steps = backend.MakeSteps(graph, nodes, lowered, 16, 32);
    const BufferAssignment assignment =
        AssignBuffers(lowered, ScratchBytes(steps), /*keeps_values=*/false);
    ExpectNoOverlap(assignment.pieces, assignment.offsets, assignment.bytes);
    if (HasFatalFailure()) return;
    EXPECT_GE(assignment.bytes, LeastBytes(assignment.pieces));
    EXPECT_LE(assignment.bytes, assignment.separate_bytes);
  }
}

}  // namespace
}  // namespace orb360::nn
