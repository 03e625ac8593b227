#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "nn/kernels/confidence_pool.h"
#include "nn/kernels/normalized_chain.h"
#include "tests/nn/kernels/plain_image.h"

namespace orb360::nn {

/// A multi-scale network of normalized convolutions put together by hand: chains of them on every
/// level of a pyramid that is pooled by confidence, then a chain per level that joins it with what
/// comes from below.
class PropagationNetwork {
 public:
  struct Decoder {
    NormalizedChain chain;
    bool skip_first;  // the order in which its two inputs are concatenated
  };

  /// `decoders` begin at the level above the last; the first of them ends in `decoders.back()`.
  PropagationNetwork(std::vector<NormalizedChain> encoders, std::vector<Decoder> decoders,
                     ConfidenceRule rule, int height, int width, int threads)
      : encoders_(std::move(encoders)),
        decoders_(std::move(decoders)),
        rule_(rule),
        threads_(threads),
        scratch_(ScratchBytes(width, threads)) {
    for (std::size_t k = 0; k < encoders_.size(); ++k) {
      const Shape shape{2, height >> k, width >> k};
      levels_.push_back(std::make_unique<Pair>(shape));
      pooled_.push_back(std::make_unique<Pair>(shape));
      joined_.push_back(std::make_unique<Pair>(shape));
    }
  }

  void Run(const ConfidentTensor& input, const ConfidentTensor& output) {
    for (std::size_t k = 0; k < encoders_.size(); ++k) {
      const NormalizedInput source{k == 0 ? input : pooled_[k]->tensors()};
      if (k + 1 < encoders_.size()) {
        const PooledOutput pooled{pooled_[k + 1]->tensors(), rule_};
        encoders_[k].Run({&source, 1}, level(k), scratch_.bytes, threads_, &pooled);
      } else {
        encoders_[k].Run({&source, 1}, level(k), scratch_.bytes, threads_);
      }
    }
    ConfidentTensor below = level(encoders_.size() - 1);
    for (std::size_t i = 0; i < decoders_.size(); ++i) {
      const std::size_t k = decoders_.size() - 1 - i;
      const NormalizedInput skip{level(k), false};
      const NormalizedInput up{below, true};
      const NormalizedInput inputs[2] = {decoders_[i].skip_first ? skip : up,
                                         decoders_[i].skip_first ? up : skip};
      below = k == 0 ? output : joined_[k]->tensors();
      decoders_[i].chain.Run(inputs, below, scratch_.bytes, threads_);
    }
  }

  /// What the encoder's level k gave.
  ConfidentTensor level(std::size_t k) const { return levels_[k]->tensors(); }
  /// What the decoder of level k > 0 gave.
  ConfidentTensor joined(std::size_t k) const { return joined_[k]->tensors(); }

 private:
  struct Pair {
    explicit Pair(const Shape& shape)
        : x({shape, Layout::kPlanar, DataType::kFloat, 0}),
          c({shape, Layout::kPlanar, DataType::kFloat, 0}) {}
    ConfidentTensor tensors() const { return {x.view, c.view}; }
    TensorMemory x;
    TensorMemory c;
  };

  std::size_t ScratchBytes(int width, int threads) const {
    std::size_t bytes = 0;
    for (const NormalizedChain& chain : encoders_) {
      bytes = std::max(bytes, chain.ScratchBytes(width, threads));
    }
    for (const Decoder& decoder : decoders_) {
      bytes = std::max(bytes, decoder.chain.ScratchBytes(width, threads));
    }
    return bytes;
  }

  std::vector<NormalizedChain> encoders_;
  std::vector<Decoder> decoders_;
  ConfidenceRule rule_;
  int threads_;
  Scratch scratch_;
  std::vector<std::unique_ptr<Pair>> levels_;
  std::vector<std::unique_ptr<Pair>> pooled_;
  std::vector<std::unique_ptr<Pair>> joined_;
};

/// A layer of random weights.
inline NormalizedConvolution RandomLayer(int outputs, int inputs, int size, Padding padding,
                                         unsigned seed) {
  const std::size_t taps = static_cast<std::size_t>(outputs) * inputs * size * size;
  return {RandomFloats(taps, 0.01f, 1.0f, seed),
          RandomFloats(outputs, -0.1f, 0.1f, seed + 1),
          outputs,
          inputs,
          size,
          padding};
}

/// The published unguided network (Eldesokey et al., PAMI 2019) from its layers N1 to N7: four
/// levels, confidences divided by 4 from one to the next.
inline PropagationNetwork UnguidedNetwork(const std::vector<NormalizedConvolution>& n, int height,
                                          int width, int threads) {
  return {{NormalizedChain({n[0], n[1], n[2]}), NormalizedChain({n[1], n[2]}),
           NormalizedChain({n[1]}), NormalizedChain({n[1]})},
          {{NormalizedChain({n[3]}), true},
           {NormalizedChain({n[4]}), true},
           {NormalizedChain({n[5], n[6]}), false}},
          ConfidenceRule::kQuarter,
          height,
          width,
          threads};
}

inline std::vector<NormalizedConvolution> RandomUnguidedLayers() {
  const Padding padding = Padding::kZero;
  return {RandomLayer(2, 1, 5, padding, 1), RandomLayer(2, 2, 5, padding, 2),
          RandomLayer(2, 2, 5, padding, 3), RandomLayer(2, 4, 3, padding, 4),
          RandomLayer(2, 4, 3, padding, 5), RandomLayer(2, 4, 3, padding, 6),
          RandomLayer(1, 2, 1, padding, 7)};
}

/// Seven levels with the square root of the confidence from one to the next, as the project's own
/// network has them.
inline PropagationNetwork SevenLevelNetwork(Padding padding, int height, int width, int threads) {
  std::vector<NormalizedChain> encoders = {
      NormalizedChain({RandomLayer(2, 1, 5, padding, 1), RandomLayer(2, 2, 5, padding, 2)})};
  std::vector<PropagationNetwork::Decoder> decoders;
  for (unsigned i = 1; i < 7; ++i) {
    encoders.push_back(NormalizedChain({RandomLayer(2, 2, 5, padding, 3)}));
    std::vector<NormalizedConvolution> layers = {RandomLayer(2, 4, 3, padding, 10 + i)};
    if (i == 6) layers.push_back(RandomLayer(1, 2, 1, padding, 20));
    decoders.push_back({NormalizedChain(std::move(layers)), true});
  }
  return {std::move(encoders),
          std::move(decoders),
          ConfidenceRule::kSquareRoot,
          height,
          width,
          threads};
}

}  // namespace orb360::nn
