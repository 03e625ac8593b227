#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "slam/pipeline/system.h"

namespace orb360 {

/// Shows on standard output how far a run is: a bar that is redrawn on a terminal, elsewhere a
/// line every few seconds; and a line whenever the state changes (first map, lost, found again).
class Progress {
 public:
  /// `frame_count` as Sequence estimates it. Quiet: nothing is shown.
  Progress(std::optional<int> frame_count, bool is_quiet);
  /// Ends the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// After each frame; `index` is its Frame::index.
  void Update(int index, const FrameReport& report);

  /// A line for standard error that must not end up in the middle of the bar.
  void Warn(const std::string& line);

  int num_frames() const { return num_frames_; }

 private:
  void ReportEvent(int index, const FrameReport& report);
  void ClearBar();
  std::string Status(const FrameReport& report) const;
  std::string Bar() const;

  const std::optional<int> frame_count_;
  const bool is_quiet_;
  const bool is_terminal_;
  const std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_shown_;
  int num_frames_ = 0;
  bool bar_is_shown_ = false;
  TrackingState state_ = TrackingState::kInitializing;
  int map_ = 0;
};

}  // namespace orb360
