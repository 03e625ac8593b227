#include "slam/pipeline/keyframe_completion.h"

#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "slam/depth/range_prior.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

KeyframeCompletion::KeyframeCompletion(DepthCompleter* completer, DepthSink sink,
                                       const DepthOptions& options)
    : completer_(completer), sink_(std::move(sink)), options_(options) {}

bool KeyframeCompletion::Start(const Keyframe& keyframe, const cv::Mat& color,
                               std::vector<SparsePoint> points, int num_frames) {
  ORB360_CHECK(!job_);
  if (static_cast<int>(points.size()) < options_.min_points) return false;
  std::promise<Found> found;
  job_ = Job{.found = found.get_future(),
             .frame_index = keyframe.frame_index,
             .due = num_frames + options_.adoption_frames};
  auto complete = [this, index = keyframe.frame_index, features = keyframe.features,
                   landmarks = keyframe.landmarks, color, points = std::move(points),
                   found = std::move(found), previous = std::move(stored_)]() mutable {
    DenseDepth depth;
    try {
      if (previous.valid()) previous.get();
      depth = completer_->Complete(color, RenderSparseDepth(points, completer_->camera()));
      found.set_value({SampleRangePriors(depth, *features, landmarks),
                       FindGround(depth, Eigen::Vector3d::UnitZ(), options_.ground)});
    } catch (...) {
      found.set_exception(std::current_exception());
      return;
    }
    sink_(index, std::move(depth));
  };
  stored_ = std::async(std::launch::async, std::move(complete));
  return true;
}

std::optional<int> KeyframeCompletion::pending() const {
  return job_ ? std::optional(job_->frame_index) : std::nullopt;
}

bool KeyframeCompletion::IsRunning() const {
  return stored_.valid() && stored_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

void KeyframeCompletion::Flush() {
  if (stored_.valid()) stored_.get();
}

CompletedKeyframe KeyframeCompletion::Take(double unit_scale) {
  Job job = std::move(job_.value());
  job_.reset();
  Found found = job.found.get();
  for (RangePrior& prior : found.priors) prior.range *= static_cast<float>(unit_scale);
  if (found.ground) found.ground->log_height += std::log(unit_scale);
  return {
      .frame_index = job.frame_index, .priors = std::move(found.priors), .ground = found.ground};
}

}  // namespace orb360
