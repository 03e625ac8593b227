#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "slam/geometry/camera.h"
#include "slam/pipeline/frame_report.h"
#include "slam/pipeline/reconstruction.h"

namespace cv {
class Mat;
}
namespace orb360 {

class Map;
class Pipeline;
class DepthMapStore;
struct Frame;
struct KnownGround;
struct Options;
struct StoredMap;

/// The whole system: frames in, poses, maps and dense depth out. For one thread at a time; the
/// result is the same for any number of threads that it uses itself (Options::num_threads).
class System {
 public:
  /// `mask`: CV_8U of the frames' size, 0 where features are left out; may be empty.
  System(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask);
  ~System();

  /// Before the first frame: goes on in a map made earlier, in which the camera is to be found.
  void LoadMap(const StoredMap& stored);
  /// The same, but the map stays as it is, and frames are only located in it.
  void Localize(const StoredMap& stored);
  /// Before the first frame: keyframes get dense depth beside tracking, by the network in
  /// `weights`. It is kept in `folder` while the system lives. Throws UserError where a file is at
  /// fault.
  void CompleteDepth(const std::filesystem::path& weights, const std::filesystem::path& folder);

  /// The next frame; timestamps must grow. Throws ContractError for an image of another size or
  /// type than 8-bit BGR. After another exception only Finish may be called.
  FrameReport Process(const Frame& frame);
  /// Waits for mapping and returns everything computed. The system takes no further frames.
  Reconstruction Finish();

  // After Finish:
  /// The maps in the order they were begun, and the ground under each; with one it is in metres.
  std::span<const Map> maps() const;
  std::span<const std::optional<KnownGround>> grounds() const;
  /// Depth of the keyframes in Reconstruction::depth_scales; null without CompleteDepth. Throws
  /// UserError where it could not be kept.
  const DepthMapStore* depth_maps() const;

 private:
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace orb360
