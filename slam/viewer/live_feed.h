#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>

#include "slam/viewer/live_snapshot.h"
#include "slam/viewer/resource.h"

namespace orb360 {

/// Stands between a run, on its own thread, and the pages that show it, on that of a server. A page
/// asks for what it shows; the run copies its state when one has asked since the last copy, and
/// never waits for a page. What happens between two copies is not shown.
class LiveFeed {
 public:
  // --- called by the run ---
  /// Copies a state if a page wants it (System::Watch).
  void Take(const PresentState& state);
  /// Waits while a page has paused the run, unless `is_ended` returns true. False where the run is
  /// to end early.
  bool WaitForTurn(const std::function<bool()>& is_ended);

  // --- called by the server ---
  /// `live.json`, `live.points`, `live.jpg`, and the actions `pause`, `resume`, `step`, `finish`.
  /// They refer to this object.
  ResourceTable Resources();

 private:
  std::atomic<bool> is_wanted_ = true;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by the mutex:
  std::optional<LiveSnapshot> latest_;
  bool is_paused_ = false;
  bool is_finishing_ = false;
  int steps_ = 0;  ///< Frames that may pass although the run is paused.
  // Used by the run only:
  std::optional<Rigid3> first_pose_;  ///< Of the present map.
  int map_number_ = -1;               ///< The map of first_pose_.
};

}  // namespace orb360
