#pragma once

#include <filesystem>
#include <memory>

#include <opencv2/core.hpp>

#include "slam/depth/dense_depth.h"
#include "slam/depth/sparse_depth.h"
#include "slam/geometry/camera.h"

namespace orb360 {

struct DepthCompleterOptions {
  /// Of the pictures that are completed; each shows a full sphere.
  cv::Size size{1024, 512};
  int threads = 1;
  /// Convolutions in bfloat16: faster, less exact. UserError where the processor cannot.
  bool bfloat16 = false;
};

/// Depth completion of keyframes by a network (paper III-C). One thread at a time.
class DepthCompleter {
 public:
  /// `weights`: a network file. Throws UserError where it cannot be read or is for something else.
  DepthCompleter(const std::filesystem::path& weights, const DepthCompleterOptions& options);
  ~DepthCompleter();

  /// Of the pictures that are completed: what ProjectLandmarks and Complete work with.
  const EquirectangularCamera& camera() const { return camera_; }

  /// `color`: CV_8UC3, BGR, of the camera's size, like `sparse`; the result is in its unit.
  DenseDepth Complete(const cv::Mat& color, const SparseDepth& sparse);

 private:
  struct Network;
  EquirectangularCamera camera_;
  std::unique_ptr<Network> network_;
};

}  // namespace orb360
