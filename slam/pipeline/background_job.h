#pragma once

#include <chrono>
#include <future>
#include <utility>

namespace orb360 {

/// When the result of a job is adopted. This depends on frames and matches only, never on whether
/// the job has ended, because results would otherwise depend on the speed of the machine.
struct AdoptionTime {
  /// The result is due when this many frames have been processed ...
  int num_frames = 0;
  /// ... or as soon as a frame has fewer inliers among the landmarks than this.
  double min_inliers = 0;
};

/// Work that runs on a thread of its own. The destructor waits for it.
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
  /// Waits for the result and returns it, or throws what the work has thrown. It may be called
  /// once.
  Result Take() { return result_.get(); }

 private:
  std::future<Result> result_;
  AdoptionTime adoption_;
};

}  // namespace orb360
