#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "slam/pipeline/atlas.h"
#include "slam/pipeline/back_end.h"
#include "slam/pipeline/dense_mapper.h"
#include "slam/pipeline/front_end.h"
#include <orb360/slam/io/frame_source.h>
#include <orb360/slam/io/map_file.h>
#include <orb360/slam/pipeline/present_state.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {

/// Passes each frame through the parts of the system, each of which owns its state. A MapUpdate
/// tells the other parts about a change of the map.
///
/// The results are the same for any number of threads, because the map has one owner. While a new
/// keyframe is mapped, the map belongs to that job, which returns it at a frame that is fixed when
/// the job starts. Tracking uses a copy of the map's neighbourhood in the meantime.
class Pipeline {
 public:
  Pipeline(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask);

  // These are the functions of System.
  void LoadMap(const StoredMap& stored, bool keeps_map);
  void EnableDepth(const std::filesystem::path& weights, const std::filesystem::path& folder,
                   const nn::Device& device);
  void Watch(const Watcher& watcher) { watcher_ = watcher; }
  FrameReport Process(const Frame& frame);
  Reconstruction Finish(const Positions& positions);
  ViewDepthReport ComputeDepth(const Reconstruction& finished, const ViewDepthCallbacks& callbacks);

  const Atlas& atlas() const { return atlas_; }
  const std::optional<DenseMapper>& dense() const { return dense_; }

 private:
  // Results that are due are adopted before a frame; jobs are started after it.
  void AdoptDue();
  void StartDue(const cv::Mat& image);
  /// Shows the state after tracking to the watcher, before jobs take the map.
  void ShowState(const Frame& frame, const PendingFrame& pending) const;
  /// Keeps the image of a frame for dense depth.
  void KeepImage(const Frame& frame);

  // One function for each state of the front end.
  void Track(const PendingFrame& frame);
  void Recover(const PendingFrame& frame);
  void Initialize(const PendingFrame& frame);

  // Start of jobs and adoption of their results.
  /// Makes the last frame a keyframe. `image` may be empty where no other frame follows.
  void StartMapping(const cv::Mat& image);
  void MapLastFrame();
  void StartLoopCorrection();
  void StartAdjustment();
  void AdoptMap();
  void Adopt(MappedKeyframe mapped);
  void Adopt(CorrectedLoop corrected);
  void AdoptAdjustment();
  void AdoptDepth();
  /// Closes the loop that the newest keyframe has found, if it has.
  void CloseFoundLoop();
  /// Adopts all pending results, maps the last frame, and adjusts the map once more where loops
  /// were closed.
  void FinishMap();
  void CorrectScale(const Positions& positions);

  /// Adapts everything that refers to the present map to a change of the map.
  void Apply(const MapUpdate& update);
  /// Takes over a ground. `changes_unit`: the map is scaled first, so that the camera has the
  /// height of the options over it.
  void FollowGround(const KnownGround& ground, bool changes_unit);
  void LookForDenseGround();
  void CountMap();
  int FreeThreads() const;

  const EquirectangularCamera camera_;
  const Options options_;
  const int num_threads_;
  FrontEnd front_end_;
  /// Declared before the jobs, which refer to it until they end.
  Atlas atlas_;
  /// Empty where keyframes get no dense depth.
  std::optional<DenseMapper> dense_;
  BackEnd back_end_;
  /// Whether frames are only localized in a loaded map, which stays as it is.
  bool keeps_map_ = false;
  bool is_map_loaded_ = false;
  Watcher watcher_;       ///< Empty where nobody watches.
  int num_frames_ = 0;    ///< Number of frames processed.
  int free_threads_ = 1;  ///< Number of OpenMP threads for the present frame.
  /// Counts of the present map when it was last not lent to a job.
  int num_keyframes_ = 0;
  int num_landmarks_ = 0;
};

}  // namespace orb360
