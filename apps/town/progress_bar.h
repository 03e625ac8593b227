#pragma once

#include <chrono>

namespace orb360::town {

/// A bar that is redrawn on a terminal, or a line from time to time elsewhere.
class ProgressBar {
 public:
  /// `made` is the number of frames made now, among the `done` that exist; the speed is computed
  /// from it.
  void Show(int done, int made, int all);

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace orb360::town
