#pragma once

#include <deque>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/orb_extractor.h"
#include "slam/io/frame_source.h"
#include "slam/map/map.h"
#include "slam/pipeline/keyframe_depth.h"
#include "slam/pipeline/local_map.h"
#include "slam/pipeline/loop_detector.h"
#include "slam/pipeline/options.h"
#include "slam/pipeline/reconstruction.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

enum class TrackingState { kInitializing, kTracking, kLost };

/// What became of one frame.
struct FrameReport {
  TrackingState state = TrackingState::kInitializing;
  std::optional<Rigid3> world_from_camera;  // as known now; Finish() has the final pose
  int map = 0;
  int num_inliers = 0;
  int num_keyframes = 0;  // of the present map, as far as it is adopted
  int num_landmarks = 0;
  /// Wall time by stage, ms: "extraction", "tracking", "adoption" (waiting for mapping) and
  /// "frame" for all together.
  std::map<std::string, double> timing_ms;
};

/// The whole system: frames in, poses and a map out.
///
/// Deterministic for any number of threads: the map has one owner. While a new keyframe is mapped
/// the map belongs to that job, which hands it back at a frame fixed when the job began; tracking
/// meanwhile uses a copy of the map's neighbourhood.
class System {
 public:
  /// `mask`: CV_8U of the frames' size, 0 where features are left out; may be empty.
  System(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask);
  ~System();
  /// Before the first frame: a map made earlier, in which the camera is to be found. `is_kept`: it
  /// stays as it is, and frames are only located in it.
  void StartIn(Map map, const std::optional<KnownGround>& ground, bool is_kept);
  System(const System&) = delete;
  System& operator=(const System&) = delete;

  /// The next frame; timestamps must grow. Throws ContractError for an image of another size or
  /// type than 8-bit BGR.
  FrameReport Process(const Frame& frame);

  /// Has keyframes completed, from now on, beside tracking. `sink` gets their depth in the order of
  /// the keyframes, one at a time, on other threads; `completer` must outlive the system.
  void CompleteKeyframes(DepthCompleter* completer, DepthSink sink);

  /// Waits for mapping and returns everything computed. The system takes no further frames.
  Reconstruction Finish();

  /// The maps, in the order they were begun; complete after Finish().
  const std::vector<Map>& maps() const { return finished_maps_; }
  /// The ground under each, where it was found; such a map is in metres.
  const std::vector<std::optional<KnownGround>>& grounds() const { return grounds_; }

 private:
  struct PendingFrame {  // without a pose so far
    int index;
    double timestamp;
    std::shared_ptr<const Features> features;  // null: forgotten
    /// How the camera is turned against an earlier frame, from which it has hardly moved.
    struct Turn {
      int reference;  // frame index
      Eigen::Quaterniond reference_from_camera;
    };
    std::optional<Turn> turn = {};
  };
  /// What changes the present map: the mapping of a keyframe, or the correction of a loop.
  struct MappingResult {
    Map map;
    std::optional<LoopDetector> loops;
    KeyframeId reference = kNoId;          // around which tracking goes on
    Similarity3 correction;                // what moved the world around it
    std::vector<SparsePoint> sparse;       // of the keyframe, where it is to be completed
    std::optional<KnownGround> ground;     // as the keyframe sees it
    std::optional<Loop> found;             // by the keyframe
    std::vector<Similarity3> corrections;  // by keyframe, where the map was bent
    std::optional<ClosedLoop> closed;      // by a correction
    std::optional<int> joined_map;         // the finished one that comes first in `map`
    KeyframeId keyframe_shift = 0;         // of what was the present map
    LandmarkId landmark_shift = 0;
  };
  struct MappingJob {
    std::future<MappingResult> result;
    TrackedFrame frame;  // the keyframe as it was tracked; of a correction the frame before it
    cv::Mat color;       // its picture, where it is to be completed
    int adopt_at;        // value of num_processed_ at which it is due
  };
  /// Bundle adjustment of a copy of the map.
  struct BundleJob {
    std::future<Map> adjusted;
    Map before;
    int adopt_at;
  };
  void TrackFrame(const PendingFrame& frame);
  void RecoverFrame(const PendingFrame& frame);
  void InitializeMap(const PendingFrame& frame);
  void Remember(PendingFrame frame);
  std::optional<TrackResult> Relocalize(const Features& features);
  void AcceptTracking(const PendingFrame& frame, TrackResult result);
  void TrackPendingBackwards(TrackedFrame last);
  void CreateMap(const PendingFrame& first, const PendingFrame& second,
                 const struct TwoViewMap& views);
  Rigid3 PredictPose(double timestamp) const;
  bool NeedsKeyframe() const;
  void StartMapping();
  bool MustAdopt() const;
  void AdoptMapping();
  void AdoptCompletion();
  std::optional<KnownGround> ReliableGround() const;
  void FollowGround(const KnownGround& ground);
  void LookForDenseGround();
  void Rescale(double factor);
  void FinishMap();
  void StartLoopCorrection();
  void StartBundle();
  void AdoptBundle();
  void SwitchToMap(int finished);
  void AdoptJoinedMap(const MappingResult& result);
  void RenumberMaps(const MapRenumbering& maps);
  void ScalePlacements(const std::vector<Similarity3>& corrections);
  void ScalePlacement(int frame_index, double factor, Placement* placement);
  void MoveTracked(const Similarity3& correction);
  void FollowCorrection(const MappingResult& result);
  void CountMap();
  void CountSightings(Map* map);
  void UpdateLocalMap();
  int FreeThreads() const;
  void Place(const TrackedFrame& frame);

  const EquirectangularCamera camera_;
  const Options options_;
  const cv::Mat mask_;
  OrbExtractor extractor_;
  const double pixel_sigma_;  // rad, on pyramid level 0
  const int num_threads_;

  TrackingState state_ = TrackingState::kInitializing;
  int num_processed_ = 0;
  int num_keyframes_ = 0;  // of the map when it was last here
  int num_landmarks_ = 0;
  int num_lost_ = 0;
  int lost_since_ = 0;
  std::optional<int> initialized_at_;  // frame index

  std::optional<KeyframeDepth> depth_;
  /// What dense depth shows of the ground under the present map, as long as that is not known.
  std::vector<DenseGround> dense_grounds_;
  cv::Mat image_;  // of the frame in Process

  std::vector<Map> finished_maps_;     // before the jobs, which look at it until they end
  Map map_;                            // empty while a job has it
  std::optional<LoopDetector> loops_;  // likewise
  std::optional<MappingJob> job_;
  std::optional<Loop> loop_;  // found, and not closed so far
  std::optional<BundleJob> bundle_;
  bool keeps_map_ = false;
  std::vector<ClosedLoop> closed_loops_;
  std::vector<ClosedLoop> joints_;
  int num_relocalized_ = 0;
  std::vector<std::optional<KnownGround>> grounds_;  // by finished map
  /// Once it is found, the map is in metres.
  std::optional<KnownGround> ground_;
  LocalMap local_;
  TrackedFrame last_;
  std::optional<TrackedFrame> before_last_;
  std::vector<LandmarkId> expected_;  // since the map was last here, see Landmark::visible
  std::vector<LandmarkId> found_;

  std::deque<PendingFrame> pending_;
  int reference_index_ = -1;  // frame index of the initializer's first view
  KeyframeId relocalization_cursor_ = 0;
  std::map<int, Placement> placements_;  // by frame index
};

}  // namespace orb360
