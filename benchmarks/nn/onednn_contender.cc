#include <algorithm>

#include <dnnl.hpp>
#include <omp.h>

#include "benchmarks/nn/contender.h"
#include "benchmarks/nn/stopwatch.h"

namespace orb360::nn {
namespace {

using dnnl::memory;

class OneDnn : public Contender {
 public:
  OneDnn(const Problem& problem, DataType type, int threads)
      : engine_(dnnl::engine::kind::cpu, 0), stream_(engine_), threads_(threads) {
    const auto [name, in, out, kernel, stride, reduction, may_tile] = problem.layer;
    const bool is_int8 = type == DataType::kInt8;
    const auto as =
        is_int8 ? memory::data_type::s8
                : (type == DataType::kFloat ? memory::data_type::f32 : memory::data_type::bf16);
    const auto result = is_int8 ? memory::data_type::f32 : as;
    // Inputs are from -1 to 1. One scale for all weights does for a comparison of times.
    const float largest = *std::max_element(problem.weight.begin(), problem.weight.end());
    const float in_steps = is_int8 ? 127 : 1;
    const float weight_steps = is_int8 ? 127 / largest : 1;
    const auto scaled = [](float factor) {
      dnnl::primitive_attr attributes;
      if (factor != 1) attributes.set_output_scales(0, {factor});
      return attributes;
    };
    const memory::dims in_dims{1, in, problem.height, problem.width};
    const memory::dims weight_dims{out, in, kernel, kernel};
    out_dims_ = {1, out, problem.out_height(), problem.out_width()};
    const auto any = memory::format_tag::any;
    const memory::dim reach = kernel / 2;
    // What the last window reaches beyond the last row and column.
    const auto beyond = [&, s = stride, k = kernel](int outputs, int inputs) {
      return memory::dim{(outputs - 1) * s + k - inputs} - reach;
    };
    const dnnl::convolution_forward::desc description(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto, {in_dims, as, any},
        {weight_dims, as, any}, {{out}, memory::data_type::f32, memory::format_tag::a},
        {out_dims_, result, any}, {stride, stride}, {reach, reach},
        {beyond(problem.out_height(), problem.height), beyond(problem.out_width(), problem.width)});
    const dnnl::convolution_forward::primitive_desc primitive(
        description, scaled(1 / (in_steps * weight_steps)), engine_);
    convolution_ = dnnl::convolution_forward(primitive);
    const auto fill = [&](const std::vector<float>& values, const memory::dims& dims,
                          memory::format_tag tag, const memory::desc& wanted, float steps) {
      memory plain({dims, memory::data_type::f32, tag}, engine_, const_cast<float*>(values.data()));
      memory filled(wanted, engine_);
      dnnl::reorder(plain, filled, scaled(steps)).execute(stream_, plain, filled);
      stream_.wait();
      return filled;
    };
    output_ = memory(primitive.dst_desc(), engine_);
    arguments_ = {{DNNL_ARG_SRC, fill(problem.input, in_dims, memory::format_tag::nchw,
                                      primitive.src_desc(), in_steps)},
                  {DNNL_ARG_WEIGHTS, fill(problem.weight, weight_dims, memory::format_tag::oihw,
                                          primitive.weights_desc(), weight_steps)},
                  {DNNL_ARG_BIAS, fill(problem.bias, {out}, memory::format_tag::a,
                                       primitive.bias_desc(), in_steps * weight_steps)},
                  {DNNL_ARG_DST, output_}};
  }

  void Run() override {
    omp_set_num_threads(threads_);
    Time(
        [&] {
          convolution_.execute(stream_, arguments_);
          stream_.wait();
        },
        &milliseconds_);
  }
  std::vector<double> Milliseconds() override { return milliseconds_; }
  std::vector<float> Answer() override {
    std::vector<float> answer(out_dims_[1] * out_dims_[2] * out_dims_[3]);
    memory plain({out_dims_, memory::data_type::f32, memory::format_tag::nchw}, engine_,
                 answer.data());
    dnnl::reorder(output_, plain).execute(stream_, output_, plain);
    stream_.wait();
    return answer;
  }

 private:
  dnnl::engine engine_;
  dnnl::stream stream_;
  int threads_;
  memory::dims out_dims_;
  dnnl::convolution_forward convolution_;
  memory output_;
  std::unordered_map<int, memory> arguments_;
  std::vector<double> milliseconds_;
};

}  // namespace

std::unique_ptr<Contender> MakeOneDnn(const Problem& problem, DataType type, int threads) {
  try {
    omp_set_num_threads(threads);  // its kernels are made for a number of threads
    return std::make_unique<OneDnn>(problem, type, threads);
  } catch (const dnnl::error& error) {
    if (error.status == dnnl_unimplemented) return nullptr;
    throw;
  }
}

}  // namespace orb360::nn
