#pragma once

#include <chrono>
#include <optional>
#include <string>

#include <orb360/slam/pipeline/system.h>

namespace orb360 {

/// Shows the progress of a run on standard output: on a terminal a bar that is redrawn, elsewhere a
/// line every few seconds. In addition it prints a line whenever the state changes (first map,
/// tracking lost, camera found again).
class Progress {
 public:
  /// `frame_count` is the estimate of Sequence. With `is_quiet` nothing is shown.
  Progress(std::optional<int> frame_count, bool is_quiet);
  /// Ends the line of the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows the state after a frame; `index` is its Frame::index.
  void Update(int index, const FrameReport& report);

  /// Shows how far a step after the last frame has got; `what` names what is counted.
  void Update(const std::string& step, int done, int count, const std::string& what);

  /// Prints a line on standard error and keeps it apart from the bar.
  void Warn(const std::string& line);

  int num_frames() const { return num_frames_; }

 private:
  void ReportEvent(int index, const FrameReport& report);
  void ClearBar();
  std::string Status(const FrameReport& report) const;
  /// Shows a line of status if the last one is long enough ago, or if it `must` be shown.
  void Show(int done, std::optional<int> count, bool must, const std::string& status);

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
