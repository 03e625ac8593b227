#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/graph.h>
#include <orb360/nn/models/image_size.h>

namespace orb360::nn {

/// A panorama with sparse depth. All arrays have the size of the DepthCompletion, row by row.
struct CompletionInput {
  /// Red, green and blue of each pixel, 0 to 255.
  std::span<const std::uint8_t> rgb;
  /// Range along each pixel's ray, in any unit. Pixels whose range is not finite and positive, or
  /// whose confidence is not positive, are not points.
  std::span<const float> depth;
  /// Confidence of each point, in (0, 1]; larger values count as 1.
  std::span<const float> confidence;
};

/// The completed panorama. All images have the size of the DepthCompletion, row by row.
struct CompletionOutput {
  /// Range along each pixel's ray, in the unit of the points; 0 where the network gives none.
  std::vector<float> depth;
  /// Confidence c of each pixel in 0..1: 1 / c - 1 is the expected relative error of the depth.
  std::vector<float> confidence;
  /// Probability of each pixel that it shows the plane of the road under the camera; empty if the
  /// network does not give it.
  std::vector<float> ground;
  /// ln(`scale` in metres / height of the camera in metres), if the network gives it.
  std::optional<float> log_metric_scale;
  /// The range to which log_metric_scale refers, in the unit of the points.
  float scale = 1;
};

/// Depth completion by a network with the inputs and outputs of docs/formats/network.md, for
/// panoramas of one size. It never changes, so several threads may use it at once, each with a
/// workspace of its own.
class DepthCompletion {
 public:
  /// Memory of one completion. A workspace serves one completion at a time.
  class Workspace {
   public:
    /// Allocates the memory. Throws UserError where there is too little, and DeviceError where a
    /// device has too little or fails.
    explicit Workspace(const DepthCompletion& model);

   private:
    friend class DepthCompletion;
    Executor::Workspace network_;
    std::vector<std::vector<float>> inputs_;
    std::vector<std::vector<float>> outputs_;
  };

  /// Throws UserError for a network that is not for depth completion, and DeviceError where a
  /// device has too little memory or fails. Images are resampled to the width that the network's
  /// normalisation states, if any, and to the nearest size that it takes.
  DepthCompletion(const Graph& graph, ImageSize size, const ExecutorOptions& options = {});

  /// Returns the size of the images that are completed.
  ImageSize size() const { return size_; }
  /// Returns the size of the images at which the network runs.
  ImageSize network_size() const { return network_size_; }

  /// Completes the depth of one panorama. Throws ContractError where an array of `image` has not
  /// the size of this model or `workspace` is one of another model, and DeviceError where a device
  /// fails.
  CompletionOutput Complete(const CompletionInput& image, Workspace* workspace) const;

 private:
  struct Ports {  // indices of the executor's inputs and outputs
    std::optional<std::size_t> image, log_depth, scale, log_metric_scale, ground;
    std::size_t sparse_depth = 0, sparse_confidence = 0;
    std::size_t depth = 0, confidence = 0;  // depth: of `depth` or `log_depth`
  };
  static Ports FindPorts(const Graph& graph);

  void FillImage(std::span<const std::uint8_t> rgb, std::span<float> planes) const;
  void FillPoints(const CompletionInput& image, std::span<float> depth,
                  std::span<float> confidence) const;
  std::vector<float> Resampled(std::vector<float> dense) const;

  ImageSize size_;
  ImageSize network_size_;
  std::optional<float> constant_confidence_;  // in the place of the network's own
  Ports ports_;
  Executor executor_;
};

}  // namespace orb360::nn
