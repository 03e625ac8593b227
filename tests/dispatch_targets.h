#pragma once

#include <cstdint>

#include <gtest/gtest.h>
#include <hwy/highway.h>

namespace orb360 {

/// Runs `check` once for each instruction set that Highway compiled for and this processor has,
/// and names the set in every failure. The dispatch is as before afterwards.
template <typename Check>
void ForEachDispatchTarget(const Check& check) {
  struct Restore {
    ~Restore() {
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().DeInit();  // the next dispatch chooses again
    }
  } restore;
  int64_t left = hwy::SupportedTargets() & HWY_TARGETS;
  ASSERT_NE(left, 0);
  for (; left != 0; left &= left - 1) {
    const int64_t target = left & -left;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    check();
  }
}

}  // namespace orb360
