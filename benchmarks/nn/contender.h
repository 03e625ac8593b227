#pragma once

#include <memory>
#include <string>
#include <vector>

#include "benchmarks/nn/layers.h"
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// A layer at a size, with its numbers: row by row, channel by channel, kernel by kernel. Padded
/// with zeros, which all contenders know.
struct Problem {
  Layer layer;
  int height = 0;  // of the input
  int width = 0;
  std::vector<float> weight;
  std::vector<float> bias;
  std::vector<float> input;

  int out_height() const { return (height + layer.stride - 1) / layer.stride; }
  int out_width() const { return (width + layer.stride - 1) / layer.stride; }
  /// Multiplications with an addition each, those in the padding too.
  double macs() const {
    return 1.0 * layer.in_channels * layer.out_channels * layer.kernel * layer.kernel *
           out_height() * out_width();
  }
};

/// A library that can compute a problem, in the layout it likes best: times are of the convolution
/// alone, without reordering its input, output or weights.
class Contender {
 public:
  virtual ~Contender() = default;
  virtual void Run() = 0;
  /// Of all runs so far.
  virtual std::vector<double> Milliseconds() = 0;
  /// Of the last run, row by row and channel by channel.
  virtual std::vector<float> Answer() = 0;
  /// Where the convolution is computed in tiles, runs only the products and returns their number;
  /// 0 elsewhere.
  virtual double RunProducts() { return 0; }
};

std::unique_ptr<Contender> MakeOrb360(const Problem& problem, DataType type, int threads);

/// Null where the library has no such kernel for this processor.
std::unique_ptr<Contender> MakeOneDnn(const Problem& problem, DataType type, int threads);

/// `library` is the path of libonnxruntime.so.
std::unique_ptr<Contender> MakeOnnxRuntime(const Problem& problem, const std::string& library,
                                           int threads);

}  // namespace orb360::nn
