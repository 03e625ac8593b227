// Replaces the program's operator new by one that counts.

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "tests/nn/graph/network_run.h"
#include "tests/nn/graph/random_network.h"

namespace {

std::atomic<long> allocations = 0;

/// Returns nullptr when there is no memory.
void* AllocateOrNull(std::size_t bytes, std::size_t alignment) noexcept {
  ++allocations;
  // std::aligned_alloc wants whole multiples.
  const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
  return std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
}

void* Allocate(std::size_t bytes, std::size_t alignment) {
  if (void* const memory = AllocateOrNull(bytes, alignment)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t bytes) { return Allocate(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return Allocate(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return AllocateOrNull(bytes, alignof(std::max_align_t));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace orb360::nn {
namespace {

TEST(Executor, AllocatesNothingWhileItRuns) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Executor executor(RandomNetwork(60, seed).Build(), 16, 32, {.threads = 2});
    NetworkRun run(executor, RandomInputs(16, 32, seed));
    const std::vector<std::span<const float>> in(run.inputs.begin(), run.inputs.end());
    const std::vector<std::span<float>> out(run.outputs.begin(), run.outputs.end());
    Executor::Workspace workspace(executor);
    executor.Run(in, out, &workspace);  // OpenMP and the dispatch may set themselves up here
    const long before = allocations;
    executor.Run(in, out, &workspace);
    EXPECT_EQ(allocations - before, 0) << seed;
  }
  const long before = allocations;
  const std::vector<int> one(1);
  EXPECT_EQ(allocations - before, 1) << "the count itself";
}

}  // namespace
}  // namespace orb360::nn
