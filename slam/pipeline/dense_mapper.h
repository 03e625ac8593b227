#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <vector>

#include "slam/io/depth_map_store.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/keyframe_completion.h"

namespace orb360 {

/// Gives keyframes dense depth, beside tracking, and keeps it on disk. While no landmarks show the
/// ground, it collects what the depth shows of it.
class DenseMapper {
 public:
  /// `weights`: a network file. `folder` holds the depth maps as long as this lives; it is made,
  /// and removed in the end. Throws UserError where the network cannot be read or the folder not
  /// made.
  DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
              const DepthOptions& options, int num_threads);

  /// Of the images that are completed.
  const EquirectangularCamera& camera() const { return completer_.camera(); }
  bool Wants(KeyframeId id) const { return id % options_.every_keyframes == 0; }

  /// Begins with a keyframe, see KeyframeCompletion. Contract: none is pending.
  void Start(const Keyframe& keyframe, const cv::Mat& color, std::vector<SparsePoint> points,
             int num_frames);
  std::optional<int> pending() const { return completion_.pending(); }
  bool IsDue(int num_frames) const { return completion_.IsDue(num_frames); }
  bool IsRunning() const { return completion_.IsRunning(); }
  CompletedKeyframe Take(double unit_scale) { return completion_.Take(unit_scale); }
  /// Waits until all depth is on disk.
  void Flush() { completion_.Flush(); }

  /// Adds a keyframe's measurement of the ground under the present map: world, today's unit.
  void AddGround(const DenseGround& ground) { grounds_.push_back(ground); }
  /// After a change of the map or of its unit.
  void ForgetGrounds() { grounds_.clear(); }
  /// The ground by all measurements; none where they are too few or too uncertain.
  std::optional<KnownGround> Ground() const;

  /// Frame indices of the keyframes that were given depth, in their order.
  const std::vector<int>& frames() const { return frames_; }
  const DepthMapStore& depth_maps() const { return depth_maps_; }
  /// Why depth could not be kept (a full disk); null where it was. Not before Flush.
  std::exception_ptr failure() const { return failure_; }

 private:
  void Store(int frame_index, const DenseDepth& depth);

  const DepthOptions options_;
  std::vector<int> frames_;
  std::vector<DenseGround> grounds_;
  std::exception_ptr failure_;
  DepthMapStore depth_maps_;
  DepthCompleter completer_;
  KeyframeCompletion completion_;  // last: it ends before what it uses
};

}  // namespace orb360
