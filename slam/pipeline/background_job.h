#pragma once

#include <chrono>
#include <future>
#include <utility>

namespace orb360 {

/// When the result of a job is adopted. It depends on frames and matches only, never on whether the
/// job is done: that would make results depend on the machine.
struct AdoptionTime {
  int num_frames = 0;  // processed so far when it is due ...
  /// ... or due earlier, when the last frame found fewer landmarks than this.
  double min_inliers = 0;
};

/// Work on a thread of its own. The destructor waits for it.
template <typename Result>
class BackgroundJob {
 public:
  template <typename Work>
  BackgroundJob(Work work, AdoptionTime adoption)
      : result_(std::async(std::launch::async, std::move(work))), adoption_(adoption) {}

  bool IsDue(int num_frames, int num_inliers) const {
    return num_frames >= adoption_.num_frames || num_inliers < adoption_.min_inliers;
  }
  bool IsRunning() const {
    return result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  }
  /// Waits for the result, or throws what the work has thrown. Once only.
  Result Take() { return result_.get(); }

 private:
  std::future<Result> result_;
  AdoptionTime adoption_;
};

}  // namespace orb360
