#pragma once

#include <chrono>
#include <vector>

namespace orb360::nn {

/// Appends the milliseconds that `work` takes to `times`.
template <typename Work>
void Time(const Work& work, std::vector<double>* times) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  times->push_back(taken.count());
}

}  // namespace orb360::nn
