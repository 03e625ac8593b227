#pragma once

#include <filesystem>
#include <optional>

#include "slam/io/frame_source.h"
#include "slam/io/map_file.h"
#include "slam/pipeline/atlas.h"
#include "slam/pipeline/back_end.h"
#include "slam/pipeline/dense_mapper.h"
#include "slam/pipeline/front_end.h"
#include "slam/pipeline/system.h"

namespace orb360 {

/// Leads each frame through the parts of the system, each of which owns its state. What one part
/// does to the world is told to the others by a MapUpdate.
///
/// Deterministic for any number of threads: the map has one owner. While a new keyframe is mapped
/// the map belongs to that job, which hands it back at a frame fixed when the job began; tracking
/// meanwhile uses a copy of the map's neighbourhood.
class Pipeline {
 public:
  Pipeline(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask);

  // See System.
  void LoadMap(const StoredMap& stored, bool keeps_map);
  void CompleteDepth(const std::filesystem::path& weights, const std::filesystem::path& folder);
  FrameReport Process(const Frame& frame);
  Reconstruction Finish();

  const Atlas& atlas() const { return atlas_; }
  const std::optional<DenseMapper>& dense() const { return dense_; }

 private:
  // What is due before a frame, and what is started after it.
  void AdoptDue();
  void StartDue(const cv::Mat& image);

  // The frame in each state of the front end.
  void Track(const PendingFrame& frame);
  void Recover(const PendingFrame& frame);
  void Initialize(const PendingFrame& frame);

  // Jobs, and what comes of them.
  void StartMapping(const cv::Mat& image);
  void StartLoopCorrection();
  void StartAdjustment();
  void AdoptMap();
  void Adopt(MappedKeyframe mapped);
  void Adopt(CorrectedLoop corrected);
  void AdoptAdjustment();
  void AdoptDepth();
  /// Adopts all that is pending, and adjusts the map once more where loops were closed.
  void FinishMap();

  /// Lets everything that holds a pose follow a change of the present map.
  void Apply(const MapUpdate& update);
  void FollowGround(const KnownGround& ground);
  void LookForDenseGround();
  void CountMap();
  int FreeThreads() const;

  const EquirectangularCamera camera_;
  const Options options_;
  const int num_threads_;
  FrontEnd front_end_;
  Atlas atlas_;                       // before the jobs, which look at it until they end
  std::optional<DenseMapper> dense_;  // where keyframes get dense depth
  BackEnd back_end_;
  bool keeps_map_ = false;  // frames are only located in a map made earlier
  int num_frames_ = 0;      // processed
  int free_threads_ = 1;    // for the frame in Process
  int num_keyframes_ = 0;   // of the present map when it was last here
  int num_landmarks_ = 0;
};

}  // namespace orb360
