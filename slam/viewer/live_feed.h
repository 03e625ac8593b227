#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "slam/viewer/live_cloud.h"
#include "slam/viewer/live_snapshot.h"
#include "slam/viewer/resource.h"

namespace orb360 {

/// Stands between a run, on its own thread, and the pages that show it, on that of a server. A page
/// asks for what it shows; the run copies its state when one has asked since the last copy, and
/// never waits for a page: copies are made into values for a page outside the mutex. Copies of the
/// map, which grow with it, take at most a hundredth of the run's time. What happens between two
/// copies is not shown.
class LiveFeed {
 public:
  using Clock = std::chrono::steady_clock;
  /// `now` tells the time.
  explicit LiveFeed(std::function<Clock::time_point()> now = &Clock::now) : now_(std::move(now)) {}

  // --- called by the run ---
  /// Shows what is left out of all images: CV_8U, 0 there; empty for nothing. To be called before
  /// the first frame.
  void SetMask(const cv::Mat& mask);
  /// Adds the wall times of a frame (FrameReport::timing_ms); those of the last frames are shown.
  void AddTimes(const std::map<std::string, double>& timing_ms);
  /// Copies a state if a page wants it (System::Watch).
  void Take(const PresentState& state);
  /// Waits while a page has paused the run, unless `is_ended` returns true. False where the run is
  /// to end early.
  bool WaitForTurn(const std::function<bool()>& is_ended);
  /// No further frame comes; what is left of the run may take minutes.
  void End();
  /// Shows the finished maps in place of the present one. `world_from_map` is the world of written
  /// files.
  void ShowFinished(std::span<const Map> maps, const Rigid3& world_from_map);
  /// Shows how far the work after that has got.
  void ShowProgress(const LiveControl::Progress& progress);
  /// Shows the depth of a view with its pose in the finished maps.
  void AddView(int frame, const Rigid3& map_from_camera, const DenseDepth& depth);

  // --- called by the server ---
  /// `live.json`, `live.points`, `live.cloud`, `live.image`, `live.mask`, and the actions `pause`,
  /// `resume`, `step`, `finish`. They refer to this object.
  ResourceTable Resources();

 private:
  std::shared_ptr<const LiveSnapshot> Latest() const;
  std::string StateSince(std::uint64_t since);

  std::atomic<bool> is_wanted_ = true;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by the mutex:
  std::shared_ptr<const LiveSnapshot> latest_ = std::make_shared<LiveSnapshot>();
  LiveControl control_;
  std::map<std::string, std::deque<double>> times_;  ///< Of the last frames, ms by stage.
  cv::Mat mask_;
  int steps_ = 0;    ///< Frames that may pass although the run is paused.
  LiveCloud cloud_;  ///< Has a mutex of its own.
  // Used by the run only:
  std::function<Clock::time_point()> now_;
  Clock::time_point next_map_;        ///< The map is not copied again before.
  std::optional<Rigid3> first_pose_;  ///< Of the present map.
  int map_number_ = -1;               ///< The map of first_pose_.
};

}  // namespace orb360
