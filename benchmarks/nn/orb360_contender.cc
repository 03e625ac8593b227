#include <algorithm>

#include "benchmarks/nn/contender.h"
#include "benchmarks/nn/stopwatch.h"
#include "nn/kernels/convolution.h"
#include <orb360/nn/base/aligned_vector.h>

namespace orb360::nn {
namespace {

class Orb360 : public Contender {
 public:
  Orb360(const Problem& problem, DataType type, int threads)
      : threads_(threads),
        convolution_({problem.layer.in_channels, problem.layer.out_channels, problem.layer.kernel,
                      problem.layer.stride, Padding::kZero, 1, type, problem.layer.may_tile, -1, 1},
                     problem.weight, problem.bias) {
    const Shape shape{problem.layer.in_channels, problem.height, problem.width};
    const bool is_stem = shape.channels <= kMaxPlanarChannels;
    const TensorFormat planar{shape, Layout::kPlanar, DataType::kFloat, 0};
    const TensorFormat input{shape, is_stem ? Layout::kPlanar : Layout::kBlocked,
                             is_stem || type == DataType::kInt8 ? DataType::kFloat : type,
                             problem.layer.kernel / 2};
    const TensorFormat output{convolution_.OutputShape(shape), Layout::kBlocked,
                              type == DataType::kInt8 ? DataType::kFloat : type, 0};
    AlignedVector<std::byte> planar_memory(planar.bytes());
    const TensorView plain = planar.View(planar_memory.data());
    const float* next = problem.input.data();
    for (int c = 0; c < shape.channels; ++c) {
      for (int y = 0; y < shape.height; ++y, next += shape.width) {
        std::copy_n(next, shape.width, plain.row<float>(c, y));
      }
    }
    scratch_.resize(convolution_.ScratchBytes(shape, threads));
    input_memory_.resize(input.bytes());
    output_memory_.resize(output.bytes());
    input_ = input.View(input_memory_.data());
    output_ = output.View(output_memory_.data());
    Reorder(plain, input_);
  }

  void Run() override {
    Time([&] { convolution_.Run(input_, nullptr, output_, scratch_, threads_); }, &milliseconds_);
  }
  double RunProducts() override {
    return static_cast<double>(convolution_.RunProducts(input_, scratch_, threads_));
  }
  std::vector<double> Milliseconds() override { return milliseconds_; }
  std::vector<float> Answer() override {
    const TensorFormat planar{output_.shape, Layout::kPlanar, DataType::kFloat, 0};
    AlignedVector<std::byte> memory(planar.bytes());
    const TensorView plain = planar.View(memory.data());
    Reorder(output_, plain);
    std::vector<float> answer;
    for (int c = 0; c < plain.shape.channels; ++c) {
      for (int y = 0; y < plain.shape.height; ++y) {
        const float* row = plain.row<float>(c, y);
        answer.insert(answer.end(), row, row + plain.shape.width);
      }
    }
    return answer;
  }

 private:
  int threads_;
  Convolution convolution_;
  AlignedVector<std::byte> scratch_;
  AlignedVector<std::byte> input_memory_;
  AlignedVector<std::byte> output_memory_;
  TensorView input_;
  TensorView output_;
  std::vector<double> milliseconds_;
};

}  // namespace

std::unique_ptr<Contender> MakeOrb360(const Problem& problem, DataType type, int threads) {
  return std::make_unique<Orb360>(problem, type, threads);
}

}  // namespace orb360::nn
