#pragma once

#include <exception>
#include <filesystem>
#include <future>
#include <optional>
#include <span>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/io/depth_map_store.h"
#include "slam/io/gray_image_store.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/keyframe_completion.h"
#include <orb360/slam/pipeline/frame_report.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// Completes the depth of keyframes beside tracking and stores it on disk. While no landmarks show
/// the ground, it collects measurements of the ground from the dense depth.
class DenseMapper {
 public:
  /// `weights` is a network file. `folder` contains the depth maps during the lifetime of the
  /// object; it is created here and removed by the destructor. Throws UserError where the network
  /// cannot be read or the folder cannot be created.
  DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
              const DepthOptions& options, int num_threads);

  /// The camera of the images that are completed.
  const EquirectangularCamera& camera() const { return completer_.camera(); }
  bool Wants(KeyframeId id) const { return id % options_.every_keyframes == 0; }

  /// Starts the completion of a keyframe (KeyframeCompletion::Start). Contract: none is pending.
  void Start(const Keyframe& keyframe, const cv::Mat& color, std::vector<SparsePoint> points,
             int num_frames);
  std::optional<int> pending() const { return completion_.pending(); }
  bool IsDue(int num_frames) const { return completion_.IsDue(num_frames); }
  bool IsRunning() const { return completion_.IsRunning(); }
  CompletedKeyframe Take(double unit_scale) { return completion_.Take(unit_scale); }
  /// Waits until all depth is on disk.
  void Flush();
  /// Keeps the image (CV_8UC3, BGR) of a tracked frame for stereo, unless the camera has moved by
  /// less than a few hundredths of `median_range`, the surroundings' range, since the last one.
  void KeepImage(int frame_index, const cv::Mat& image, const Rigid3& world_from_camera,
                 double median_range);
  /// Measures the ranges of stored keyframes anew with the final poses of `views` and of all
  /// `frames` (orb360::MeasureDepth) and returns of how many. Nothing happens after a failure.
  /// Throws UserError where the disk fails. Contract: Flush has been called.
  int MeasureDepth(std::span<const DenseView> views, std::span<const FramePose> frames,
                   const KeyframeProgress& progress);

  /// Adds a keyframe's measurement of the ground under the present map, in the map's world frame
  /// and its present unit of length.
  void AddGround(const DenseGround& ground) { grounds_.push_back(ground); }
  /// Drops the measurements after a change of the map or of its unit of length.
  void ForgetGrounds() { grounds_.clear(); }
  /// Returns the ground that all measurements give together. None where they are too few or too
  /// uncertain.
  std::optional<KnownGround> Ground() const;

  /// Frame indices of the keyframes that have dense depth, in the order of the keyframes.
  const std::vector<int>& frames() const { return frames_; }
  const DepthMapStore& depth_maps() const { return depth_maps_; }
  /// The error because of which depth could not be stored, such as a full disk; null where there
  /// was none. Contract: Flush has been called.
  std::exception_ptr failure() const { return failure_ ? failure_ : image_failure_; }

 private:
  void Store(int frame_index, const DenseDepth& depth);
  void AwaitImage();

  const DepthOptions options_;
  const int num_threads_;
  std::vector<int> frames_;
  std::vector<DenseGround> grounds_;
  std::exception_ptr failure_;
  std::exception_ptr image_failure_;
  DepthMapStore depth_maps_;
  GrayImageStore images_;
  std::optional<Eigen::Vector3d> last_kept_;  ///< Where the last image was kept, world frame.
  DepthCompleter completer_;
  /// Declared last, so that their threads end before the members that they use.
  KeyframeCompletion completion_;
  std::future<void> keeping_;  ///< Stores the newest image.
};

}  // namespace orb360
