#include "slam/pipeline/back_end.h"

#include <limits>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360 {

void BackEnd::Start(MapJob job, AdoptionTime adoption) {
  ORB360_CHECK(!map_job_);
  auto run = [job = std::move(job), options = options_]() mutable -> MapJobResult {
    if (auto* mapping = std::get_if<KeyframeMapping>(&job)) {
      return MapKeyframe(std::move(*mapping), options);
    }
    return CorrectLoop(std::move(std::get<LoopCorrection>(job)), options.mapper.bundle.optimizer);
  };
  map_job_.emplace(std::move(run), adoption);
}

void BackEnd::Start(GlobalAdjustment job, AdoptionTime adoption) {
  ORB360_CHECK(!adjustment_);
  auto run = [job = std::move(job), options = options_]() mutable {
    return AdjustMap(std::move(job), options);
  };
  adjustment_.emplace(std::move(run), adoption);
}

bool BackEnd::IsMapDue(int num_frames, int num_inliers) const {
  return map_job_ && map_job_->IsDue(num_frames, num_inliers);
}

bool BackEnd::IsAdjustmentDue(int num_frames) const {
  return adjustment_ && adjustment_->IsDue(num_frames, std::numeric_limits<int>::max());
}

MapJobResult BackEnd::TakeMap() {
  BackgroundJob<MapJobResult> job = std::move(map_job_.value());
  map_job_.reset();
  try {
    return job.Take();
  } catch (...) {
    adjustment_.reset();
    throw;
  }
}

AdjustedMap BackEnd::TakeAdjusted() {
  BackgroundJob<AdjustedMap> job = std::move(adjustment_.value());
  adjustment_.reset();
  try {
    return job.Take();
  } catch (...) {
    map_job_.reset();
    throw;
  }
}

}  // namespace orb360
