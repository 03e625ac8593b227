#pragma once

#include <chrono>

namespace orb360::town {

/// A bar that is redrawn on a terminal, and a line now and then elsewhere.
class ProgressBar {
 public:
  /// `made`: frames made now, of the `done` that are there, for the speed.
  void Show(int done, int made, int all);

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace orb360::town
