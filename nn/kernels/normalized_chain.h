#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nn/kernels/confidence_pool.h"
#include "nn/kernels/normalized_convolution.h"
#include "nn/tensor.h"

namespace orb360::nn {

/// Values and their confidences: two planar float tensors of one shape.
struct ConfidentTensor {
  TensorView x;
  TensorView c;
};

/// What a chain reads. `doubled`: every pixel stands for 2 x 2, as after UpsampleNearest.
struct NormalizedInput {
  ConfidentTensor tensor;
  bool doubled = false;
};

/// What ConfidencePool makes of a chain's output, wanted beside it.
struct PooledOutput {
  ConfidentTensor tensor;
  ConfidenceRule rule;
};

/// Normalized convolutions one after the other, each reading what the one before it gives. Only the
/// last result is written: the rows in between stay in the cache, which is what makes a chain
/// faster than its links. The values are those of the single convolutions bit for bit.
class NormalizedChain {
 public:
  static constexpr std::size_t kMaxLayers = 8;

  /// A chain of one is a convolution by itself.
  explicit NormalizedChain(std::vector<NormalizedConvolution> layers);

  /// Bytes of scratch for pictures of this width.
  std::size_t ScratchBytes(int width, int threads) const;

  /// Runs on the concatenation of `inputs`, in their order. The output has the height and width of
  /// the inputs, or twice those of inputs that are doubled, and must not be one of them. No halo is
  /// read, and rows of the output may be overwritten up to the next multiple of kAlignment.
  /// `scratch`, of ScratchBytes(), is aligned to kAlignment. The same bits for any number of
  /// threads. `pooled`, if not null, is written as well, from rows that are still in the cache.
  void Run(std::span<const NormalizedInput> inputs, const ConfidentTensor& output,
           std::span<std::byte> scratch, int threads, const PooledOutput* pooled = nullptr) const;

 private:
  std::vector<NormalizedConvolution> layers_;
};

}  // namespace orb360::nn
