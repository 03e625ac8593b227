#include "nn/base/cpu.h"

#include <csignal>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace orb360::nn {
namespace {

// Whether a process survives the instruction.
bool Runs(void (*instruction)()) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGILL, SIG_DFL);
    instruction();
    _exit(0);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(FindByteUnit, IsTheUnitWhoseInstructionRuns) {
#if defined(__x86_64__)
  const bool runs = Runs([] { asm volatile("vpdpbusd %%zmm0, %%zmm0, %%zmm0" ::: "xmm0"); });
  EXPECT_EQ(FindByteUnit(), runs ? ByteUnit::kVnni : ByteUnit::kNone);
#elif defined(__aarch64__)
  // sdot v0.4s, v0.16b, v0.16b
  const bool runs = Runs([] { asm volatile(".inst 0x4e809400" ::: "v0"); });
  EXPECT_EQ(FindByteUnit(), runs ? ByteUnit::kDotProduct : ByteUnit::kNone);
#else
  EXPECT_EQ(FindByteUnit(), ByteUnit::kNone);
#endif
}

}  // namespace
}  // namespace orb360::nn
