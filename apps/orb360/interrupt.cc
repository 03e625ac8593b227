#include "apps/orb360/interrupt.h"

#include <atomic>
#include <csignal>

namespace orb360 {
namespace {

std::atomic<int> caught_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free, "set in a signal handler");

void Remember(int signal) {
  caught_signal = signal;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

void CatchInterrupts() {
  std::signal(SIGINT, Remember);
  std::signal(SIGTERM, Remember);
}

int CaughtInterrupt() { return caught_signal; }

}  // namespace orb360
