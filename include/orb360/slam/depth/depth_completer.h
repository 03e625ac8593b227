#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include <orb360/nn/graph/device.h>
#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/depth/sparse_depth.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {

/// How a DepthCompleter computes.
struct DepthCompleterOptions {
  /// Size of the images that are completed, pixels; each shows a full sphere.
  cv::Size size{1024, 512};
  /// Number of OpenMP threads, at least 1. No result depends on it.
  int threads = 1;
  /// The processor on which the network runs (nn::OpenDevice), and in which type the CPU
  /// multiplies. DepthCompleter throws UserError for a type that the CPU or the network does not
  /// allow.
  nn::Device device = {};
};

/// Depth completion of keyframes by a network (paper III-C). Where a device fails, the CPU goes on
/// in its place. Not thread-safe.
class DepthCompleter {
 public:
  /// `weights` is a network file. Throws UserError if it cannot be read or is not a network for
  /// depth completion.
  DepthCompleter(const std::filesystem::path& weights, const DepthCompleterOptions& options);
  ~DepthCompleter();

  /// Returns the camera of the images that are completed; ProjectLandmarks and Complete use it.
  const EquirectangularCamera& camera() const { return camera_; }

  /// Completes a keyframe. `color` is CV_8UC3, BGR, of the camera's size, as are the images of
  /// `sparse`. The result is in the unit of `sparse`.
  DenseDepth Complete(const cv::Mat& color, const SparseDepth& sparse);

  /// Returns the name of the processor on which the network runs (nn::Device::name).
  const std::string& device() const;
  /// Returns in which type the convolutions multiply: "float", "bfloat16" or "int8".
  std::string precision() const;
  /// Returns one line that says why the CPU has taken over from a device; empty where it has not.
  const std::string& device_failure() const;

 private:
  struct Network;
  EquirectangularCamera camera_;
  std::unique_ptr<Network> network_;
};

}  // namespace orb360
