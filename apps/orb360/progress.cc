#include "apps/orb360/progress.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

#include <sys/ioctl.h>
#include <unistd.h>

namespace orb360 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kBarInterval(100);
constexpr std::chrono::seconds kLineInterval(5);
constexpr size_t kBarWidth = 24;

const char* ToString(TrackingState state) {
  switch (state) {
    case TrackingState::kInitializing:
      return "initializing";
    case TrackingState::kTracking:
      return "tracking";
    case TrackingState::kLost:
      return "lost";
  }
  return "";
}

size_t TerminalWidth() {
  constexpr size_t kUsualWidth = 80;
  winsize size{};
  const bool is_known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return is_known ? size.ws_col : kUsualWidth;
}

std::string Bar(int done, std::optional<int> count) {
  if (count.value_or(0) == 0) return {};
  const size_t length =
      std::min(kBarWidth, kBarWidth * static_cast<size_t>(done) / static_cast<size_t>(*count));
  std::string bar = "[";
  bar.append(length, '=').append(kBarWidth - length, ' ');
  return bar + "] ";
}

}  // namespace

Progress::Progress(std::optional<int> frame_count, bool is_quiet)
    : frame_count_(frame_count),
      is_quiet_(is_quiet),
      is_terminal_(isatty(STDOUT_FILENO) == 1),
      start_(Clock::now()),
      last_shown_(start_) {}

Progress::~Progress() {
  if (bar_is_shown_) std::cout << std::endl;
}

void Progress::Update(int index, const FrameReport& report) {
  ++num_frames_;
  if (is_quiet_) return;
  if (report.state != state_ || report.map != map_) ReportEvent(index, report);
  Show(num_frames_, frame_count_, num_frames_ == frame_count_, Status(report));
}

void Progress::Update(const std::string& step, int done, int count, const std::string& what) {
  if (is_quiet_) return;
  Show(done, count, done == count,
       step + ": " + std::to_string(done) + '/' + std::to_string(count) + " " + what);
}

void Progress::Show(int done, std::optional<int> count, bool must, const std::string& status) {
  const Clock::time_point now = Clock::now();
  if (is_terminal_) {
    if (now - last_shown_ < kBarInterval && !must) return;
    std::string line = Bar(done, count) + status;
    line.resize(TerminalWidth() - 1, ' ');
    std::cout << '\r' << line << std::flush;
    bar_is_shown_ = true;
  } else {
    if (now - last_shown_ < kLineInterval) return;
    std::cout << status << std::endl;
  }
  last_shown_ = now;
}

void Progress::ReportEvent(int index, const FrameReport& report) {
  std::string what = "tracking again";
  if (report.state == TrackingState::kLost) {
    what = "tracking lost";
  } else if (state_ == TrackingState::kInitializing) {
    what = "first map made";
  } else if (report.map != map_) {
    what = "map " + std::to_string(report.map + 1) + " begun";
  }
  state_ = report.state;
  map_ = report.map;
  ClearBar();
  std::cout << "frame " << index << ": " << what << std::endl;
}

void Progress::Warn(const std::string& line) {
  ClearBar();
  std::cerr << "orb360: warning: " << line << '\n';
}

void Progress::ClearBar() {
  if (bar_is_shown_) std::cout << '\r' << std::string(TerminalWidth() - 1, ' ') << '\r';
  bar_is_shown_ = false;
}

std::string Progress::Status(const FrameReport& report) const {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  std::ostringstream status;
  status << num_frames_;
  if (frame_count_) status << '/' << std::max(*frame_count_, num_frames_);
  status << " frames, " << std::lround(num_frames_ / std::max(seconds, 1e-3)) << " fps, "
         << report.num_keyframes << " keyframes, " << report.num_landmarks << " landmarks, "
         << ToString(report.state);
  return status.str();
}

}  // namespace orb360
