#include "nn/kernels/convolution.h"

#include "nn/base/check.h"

namespace orb360::nn {
namespace {

// Where a channel of pixel 0 of a row lies, and the step to the next pixel.
const float* ChannelRow(const TensorView& tensor, int channel, int y) {
  const int block = tensor.layout == Layout::kBlocked ? BlockOf(tensor.type) : 1;
  return tensor.row<float>(channel / block, y) + channel % block;
}

int PixelStep(const TensorView& tensor) {
  return tensor.layout == Layout::kBlocked ? BlockOf(tensor.type) : 1;
}

}  // namespace

Convolution::Convolution(const ConvolutionSpec& spec, std::span<const float> weight,
                         std::span<const float> bias)
    : spec_(spec), weight_(weight.begin(), weight.end()), bias_(bias.begin(), bias.end()) {
  ORB360_CHECK(spec.in_channels > 0 && spec.out_channels > 0, spec.in_channels, spec.out_channels);
  ORB360_CHECK(spec.kernel == 1 || spec.kernel == 3 || spec.kernel == 5, spec.kernel);
  ORB360_CHECK(spec.stride == 1 || spec.stride == 2, spec.stride);
  ORB360_CHECK(weight.size() == static_cast<std::size_t>(spec.out_channels) * spec.in_channels *
                                    spec.kernel * spec.kernel,
               weight.size());
  ORB360_CHECK(bias.empty() || bias.size() == static_cast<std::size_t>(spec.out_channels),
               bias.size());
  bias_.resize(spec.out_channels);
}

Shape Convolution::OutputShape(const Shape& input) const {
  return {spec_.out_channels, (input.height + spec_.stride - 1) / spec_.stride,
          (input.width + spec_.stride - 1) / spec_.stride};
}

void Convolution::Run(const TensorView& input, const TensorView* residual, const TensorView& output,
                      int threads) const {
  ORB360_CHECK(input.shape.channels == spec_.in_channels, input.shape.channels, spec_.in_channels);
  ORB360_CHECK(input.layout == Layout::kBlocked || spec_.in_channels <= kMaxPlanarChannels,
               spec_.in_channels);
  ORB360_CHECK(output.shape == OutputShape(input.shape));
  ORB360_CHECK(input.type == DataType::kFloat && output.type == DataType::kFloat);
  ORB360_CHECK(residual == nullptr ||
               (residual->shape == output.shape && residual->layout == output.layout &&
                residual->type == output.type));
  FillHalo(input, spec_.padding, spec_.kernel / 2);
  const int reach = spec_.kernel / 2;
  const int in_step = PixelStep(input);
  const int out_step = PixelStep(output);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int y = 0; y < output.shape.height; ++y) {
    for (int o = 0; o < output.planes() * out_step; ++o) {
      float* out = const_cast<float*>(ChannelRow(output, o, y));
      for (int x = 0; x < output.shape.width; ++x) {
        if (o >= spec_.out_channels) {
          out[x * out_step] = 0;
          continue;
        }
        float sum = bias_[o];
        const float* weight = weight_.data() + static_cast<std::size_t>(o) * spec_.in_channels *
                                                   spec_.kernel * spec_.kernel;
        for (int i = 0; i < spec_.in_channels; ++i) {
          for (int v = -reach; v <= reach; ++v) {
            const float* in = ChannelRow(input, i, y * spec_.stride + v);
            for (int u = -reach; u <= reach; ++u) {
              sum += *weight++ * in[(x * spec_.stride + u) * in_step];
            }
          }
        }
        if (residual != nullptr) sum += ChannelRow(*residual, o, y)[x * out_step];
        // NaN fails the comparison and stays NaN.
        out[x * out_step] = sum > 0 ? sum : spec_.slope * sum;
      }
    }
  }
}

}  // namespace orb360::nn
