#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nn/kernels/confidence_pool.h"
#include "nn/kernels/normalized_convolution.h"
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Values and their confidences: two planar float tensors of one shape.
struct ConfidentTensor {
  TensorView x;
  TensorView c;
};

/// An input of a chain. With `doubled` every pixel stands for 2 x 2, as after UpsampleNearest.
struct NormalizedInput {
  ConfidentTensor tensor;
  bool doubled = false;
};

/// The result of ConfidencePool on a chain's output, which is written too.
struct PooledOutput {
  ConfidentTensor tensor;
  ConfidenceRule rule;
};

/// A sequence of normalized convolutions, each of which reads the result of the previous one. Only
/// the last result is written; rows in between stay in the cache, which makes a chain faster than
/// its links. The values are those of the single convolutions bit for bit.
class NormalizedChain {
 public:
  static constexpr std::size_t kMaxLayers = 8;

  /// A chain of one layer is a single convolution.
  explicit NormalizedChain(std::vector<NormalizedConvolution> layers);

  /// Bytes of scratch memory for images of this width.
  std::size_t ScratchBytes(int width, int threads) const;

  /// Runs on the concatenation of `inputs` in their order. The output has the height and width of
  /// the inputs, or twice those of doubled inputs, and must not be one of them. No halo is read,
  /// and rows of the output may be overwritten up to the next multiple of kAlignment. `scratch`, of
  /// ScratchBytes(), is aligned to kAlignment. The bits are the same for any number of threads.
  /// `pooled`, if not null, is written too, from rows that are still in the cache.
  void Run(std::span<const NormalizedInput> inputs, const ConfidentTensor& output,
           std::span<std::byte> scratch, int threads, const PooledOutput* pooled = nullptr) const;

 private:
  std::vector<NormalizedConvolution> layers_;
};

}  // namespace orb360::nn
