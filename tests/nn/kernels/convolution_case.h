#pragma once

#include <string>
#include <vector>

#include "nn/kernels/convolution.h"

namespace orb360::nn {

// A convolution of random numbers, with everything that goes into it in plain arrays.
struct Case {
  ConvolutionSpec spec;
  int height = 1;
  int width = 1;
  Layout input_layout = Layout::kBlocked;
  Layout output_layout = Layout::kBlocked;
  DataType output_type = DataType::kFloat;
  bool with_bias = true;
  bool with_residual = false;

  bool is_stem() const {
    return spec.type == DataType::kBFloat16 && input_layout == Layout::kPlanar;
  }
  Shape input_shape() const { return {spec.in_channels, height, width}; }
  Shape output_shape() const {
    return {spec.out_channels, (height + spec.stride - 1) / spec.stride,
            (width + spec.stride - 1) / spec.stride};
  }
  // Of the input's tensor.
  DataType input_type() const {
    const bool is_float = is_stem() || spec.type == DataType::kInt8;
    return is_float ? DataType::kFloat : spec.type;
  }
  std::string text() const;
};

// Its numbers; `rounds`: weights and input are bfloat16's.
struct Data {
  explicit Data(const Case& c) : Data(c, c.spec.type == DataType::kBFloat16) {}
  Data(const Case& c, bool rounds);
  std::vector<float> weight, bias, input, residual;
};

// The sums in double precision, channel by channel and row by row.
std::vector<double> ExpectedValues(const Case& c, const Data& data);

void Fill(const TensorView& tensor, const std::vector<float>& values);
void RunOn(const Convolution& convolution, const TensorView& input, const TensorView* residual,
           const TensorView& output, int threads);

// The output, channel by channel, behind whatever the blocks are filled up with.
std::vector<float> Compute(const Case& c, const Data& data, int threads,
                           BFloat16Unit unit = BestBFloat16Unit());

// That the output is the sum in double precision up to rounding, the same with two threads, on
// every instruction set.
void ExpectRight(const Case& c);

}  // namespace orb360::nn
