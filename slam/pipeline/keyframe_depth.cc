#include "slam/pipeline/keyframe_depth.h"

#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "nn/base/check.h"
#include "slam/depth/range_prior.h"

namespace orb360 {

KeyframeDepth::KeyframeDepth(DepthCompleter* completer, DepthSink sink, const Options& options)
    : completer_(completer), sink_(std::move(sink)), options_(options.depth) {}

void KeyframeDepth::Start(const Keyframe& keyframe, const cv::Mat& color,
                          std::vector<SparsePoint> points, int num_frames) {
  ORB360_CHECK(!job_);
  if (static_cast<int>(points.size()) < options_.min_points) return;
  scales_[keyframe.frame_index] = 1;
  std::promise<Found> found;
  job_ = Job{found.get_future(), keyframe.frame_index, num_frames + options_.adoption_frames};
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
}

bool KeyframeDepth::IsRunning() const {
  return stored_.valid() && stored_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

void KeyframeDepth::Flush() {
  if (stored_.valid()) stored_.get();
}

KeyframeDepth::Completed KeyframeDepth::Take() {
  Job job = std::move(job_.value());
  job_.reset();
  Found found = job.found.get();
  const double scale = scales_.at(job.frame_index);
  for (RangePrior& prior : found.priors) prior.range *= static_cast<float>(scale);
  if (found.ground) found.ground->log_height += std::log(scale);
  return {job.frame_index, std::move(found.priors), found.ground};
}

void KeyframeDepth::Rescale(int frame_index, double factor) {
  const auto scale = scales_.find(frame_index);
  if (scale != scales_.end()) scale->second *= factor;
}

}  // namespace orb360
