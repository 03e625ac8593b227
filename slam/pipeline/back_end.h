#pragma once

#include <optional>
#include <variant>

#include "slam/pipeline/background_job.h"
#include "slam/pipeline/global_adjustment.h"
#include "slam/pipeline/keyframe_mapping.h"
#include "slam/pipeline/loop_correction.h"

namespace orb360 {

/// A job that changes the present map, and its result.
using MapJob = std::variant<KeyframeMapping, LoopCorrection>;
using MapJobResult = std::variant<MappedKeyframe, CorrectedLoop>;

/// Runs jobs beside tracking: one job that owns the present map, and a bundle adjustment of a copy
/// of the map. Each job is a value, runs on a thread of its own, and returns a value.
class BackEnd {
 public:
  explicit BackEnd(const Options& options) : options_(options) {}

  /// Starts a job. Contract: none of the same kind is pending.
  void Start(MapJob job, AdoptionTime adoption);
  void Start(GlobalAdjustment job, AdoptionTime adoption);

  /// Whether there is a job whose result has not been taken.
  bool has_map() const { return map_job_.has_value(); }
  bool is_adjusting() const { return adjustment_.has_value(); }
  /// Whether the result is to be adopted now (AdoptionTime). False where there is no job.
  bool IsMapDue(int num_frames, int num_inliers) const;
  bool IsAdjustmentDue(int num_frames) const;

  /// Waits for the job and returns its result. Where the job has thrown, these wait for the other
  /// job, drop its result and throw the exception again; the present map is then lost.
  MapJobResult TakeMap();
  AdjustedMap TakeAdjusted();

  /// Whether the job is still running.
  bool IsMapping() const { return map_job_ && map_job_->IsRunning(); }
  bool IsAdjusting() const { return adjustment_ && adjustment_->IsRunning(); }

 private:
  const Options options_;
  std::optional<BackgroundJob<MapJobResult>> map_job_;
  std::optional<BackgroundJob<AdjustedMap>> adjustment_;
};

}  // namespace orb360
