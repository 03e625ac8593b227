#include "apps/town/progress_bar.h"

#include <cstdio>
#include <string>

#include <unistd.h>

namespace orb360::town {

void ProgressBar::Show(int done, int made, int all) {
  constexpr int kLineEvery = 100;
  constexpr int kWidth = 40;
  static const bool is_terminal = isatty(STDERR_FILENO) != 0;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double rate = seconds > 0 ? made / seconds : 0;
  const bool is_last = done == all;
  if (is_terminal) {
    const int filled = kWidth * done / all;
    const std::string bar = std::string(static_cast<size_t>(filled), '#') +
                            std::string(static_cast<size_t>(kWidth - filled), '.');
    std::fprintf(stderr, "\r[%s] frame %d of %d, %.1f frames/s%s", bar.c_str(), done, all, rate,
                 is_last ? "\n" : "");
  } else if (is_last || done % kLineEvery == 0) {
    std::fprintf(stderr, "frame %d of %d, %.1f frames/s\n", done, all, rate);
  }
}

}  // namespace orb360::town
