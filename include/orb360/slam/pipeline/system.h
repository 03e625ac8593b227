#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include <orb360/nn/graph/device.h>
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/pipeline/frame_report.h>
#include <orb360/slam/pipeline/reconstruction.h>
#include <orb360/slam/pipeline/view_depth_report.h>
#include <orb360/slam/scale/position_fix.h>

namespace cv {
class Mat;
}
namespace orb360 {
class DepthCompleter;
class Map;
class Pipeline;
class DepthMapStore;
struct Frame;
struct KnownGround;
struct Options;
struct PresentState;
struct StoredMap;

/// The whole system, which computes poses, maps and dense depth from frames. One thread at a time
/// may use it. The result is the same for any number of threads inside (Options::num_threads).
class System {
 public:
  /// `mask` is CV_8U of the frames' size, 0 where features are left out, or empty.
  System(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask);
  ~System();
  /// Before the first frame: continues a stored map, in which the camera has to be relocalized.
  void LoadMap(const StoredMap& stored);
  /// The same, but frames are only localized in the map, which does not change.
  void Localize(const StoredMap& stored);
  /// Before the first frame: keeps images in `folder` for ComputeDepth with the network `weights`,
  /// which runs on `device`. Throws UserError where one of them cannot be used.
  void EnableDepth(const std::filesystem::path& weights, const std::filesystem::path& folder,
                   const nn::Device& device = {});

  /// Before the first frame: shows the state after each frame to a watcher.
  void Watch(const std::function<void(const PresentState&)>& watcher);

  /// Processes the next frame; timestamps must grow. Throws ContractError for an image of another
  /// size or type than 8-bit BGR. After another exception only Finish may be called.
  FrameReport Process(const Frame& frame);
  /// Waits for all jobs and returns everything; no frame may follow. `positions` add to the scale.
  Reconstruction Finish(const Positions& positions = {});

  /// Returns the maps in the order of their start, after Finish.
  std::span<const Map> maps() const;
  /// Returns the ground under each map, after Finish. A map with ground is metric.
  std::span<const std::optional<KnownGround>> grounds() const;
  /// Computes the dense depth of some frames, after Finish. Throws UserError where the disk fails.
  ViewDepthReport ComputeDepth(const Reconstruction&, const ViewDepthCallbacks& = {});
  /// Returns that depth, or null without EnableDepth. Throws UserError where images were not kept.
  const DepthMapStore* depth_maps() const;
  /// Returns what runs the network, or null without EnableDepth. No job may be running: after
  /// Finish.
  const DepthCompleter* depth_completer() const;

 private:
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace orb360
