#include "slam/pipeline/keyframe_completion.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "slam/depth/range_prior.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

void KeyframeCompletion::Start(const Keyframe& keyframe, const cv::Mat& color,
                               std::vector<SparsePoint> points, int num_frames) {
  ORB360_CHECK(!job_);
  if (static_cast<int>(points.size()) < options_.min_points) return;
  auto complete = [this, index = keyframe.frame_index, features = keyframe.features,
                   landmarks = keyframe.landmarks, color, points = std::move(points)] {
    const DenseDepth depth =
        completer_->Complete(color, RenderSparseDepth(points, completer_->camera()));
    return CompletedKeyframe{
        .frame_index = index,
        .priors = SampleRangePriors(depth, *features, landmarks),
        .ground = FindGround(depth, Eigen::Vector3d::UnitZ(), options_.ground)};
  };
  job_ = Job{.result = std::async(std::launch::async, std::move(complete)),
             .frame_index = keyframe.frame_index,
             .due = num_frames + options_.adoption_frames};
}

std::optional<int> KeyframeCompletion::pending() const {
  return job_ ? std::optional(job_->frame_index) : std::nullopt;
}

bool KeyframeCompletion::IsRunning() const {
  return job_ && job_->result.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

CompletedKeyframe KeyframeCompletion::Take(double unit_scale) {
  Job job = std::move(job_.value());
  job_.reset();
  CompletedKeyframe completed = job.result.get();
  for (RangePrior& prior : completed.priors) prior.range *= static_cast<float>(unit_scale);
  if (completed.ground) completed.ground->log_height += std::log(unit_scale);
  return completed;
}

}  // namespace orb360
