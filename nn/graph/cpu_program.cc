#include "nn/graph/cpu_program.h"

#include <chrono>
#include <new>
#include <string>
#include <utility>

#include "nn/kernels/copy_channels.h"
#include <orb360/nn/base/aligned_vector.h>
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

/// Views contiguous floats as a tensor. The view of an input is never written.
TensorView DenseView(const float* data, const Shape& shape) {
  return {const_cast<float*>(data),  // NOLINT: as above
          shape,
          Layout::kPlanar,
          DataType::kFloat,
          0,
          shape.width,
          std::ptrdiff_t{shape.width} * shape.height};
}

struct Bound {  // what one instruction works on
  std::vector<TensorView> inputs;
  std::vector<TensorView> outputs;
  std::span<std::byte> scratch;
};

struct CpuMemory : ProgramMemory {
  using ProgramMemory::ProgramMemory;

  AlignedVector<std::byte> block;
  std::vector<TensorView> views;  // by value
  std::vector<Bound> bound;       // by instruction
  std::vector<double> times;      // milliseconds of the last run; empty unless they are measured
};

/// Measures the time between calls.
class Lap {
 public:
  /// Milliseconds since the last call, or since this was made.
  double operator()() {
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double, std::milli> passed = now - std::exchange(last_, now);
    return passed.count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace

CpuProgram::CpuProgram(Lowered lowered, std::vector<Step> steps, const ProgramOptions& options,
                       int threads)
    : lowered_(std::move(lowered)),
      steps_(std::move(steps)),
      assignment_(AssignBuffers(lowered_, ScratchBytes(steps_), options.keeps_values)),
      measures_times_(options.measures_times),
      threads_(threads) {}

std::unique_ptr<ProgramMemory> CpuProgram::Allocate() const {
  auto memory = std::make_unique<CpuMemory>(this);
  try {
    memory->block.resize(assignment_.bytes);
  } catch (const std::bad_alloc&) {
    throw UserError("a network needs " + std::to_string(assignment_.bytes >> 20) +
                    " MiB of memory for an image of this size, and there is less; use a smaller "
                    "image");
  }
  for (std::size_t i = 0; i < lowered_.values.size(); ++i) {
    memory->views.push_back(ViewOf(assignment_.buffers[i], lowered_.values[i].format.shape.channels,
                                   memory->block.data()));
  }
  const auto views = [&](const std::vector<int>& values) {
    std::vector<TensorView> list;
    list.reserve(values.size());
    for (const int value : values) list.push_back(memory->views[Index(value)]);
    return list;
  };
  const std::span<std::byte> block(memory->block);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Instruction& instruction = lowered_.instructions[i];
    memory->bound.push_back({views(instruction.inputs), views(instruction.outputs),
                             block.subspan(assignment_.scratch[i], steps_[i].scratch_bytes)});
  }
  if (measures_times_) memory->times.reserve(steps_.size() + 2);
  return memory;
}

void CpuProgram::Run(std::span<const std::span<const float>> inputs,
                     std::span<const std::span<float>> outputs, ProgramMemory* memory) const {
  ORB360_CHECK(memory->IsOf(this), "a workspace of another executor");
  auto& cpu = static_cast<CpuMemory&>(*memory);
  cpu.times.clear();
  Lap lap;
  const auto measure = [&] {
    if (measures_times_) cpu.times.push_back(lap());
  };
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const TensorView& to = cpu.views[Index(lowered_.inputs[i])];
    CopyChannels(DenseView(inputs[i].data(), to.shape), 0, to, 0, to.shape.channels, threads_);
  }
  measure();
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    steps_[i].run(cpu.bound[i].inputs, cpu.bound[i].outputs, cpu.bound[i].scratch);
    measure();
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const TensorView& from = cpu.views[Index(lowered_.outputs[i])];
    CopyChannels(from, 0, DenseView(outputs[i].data(), from.shape), 0, from.shape.channels,
                 threads_);
  }
  measure();
}

std::vector<double> CpuProgram::Times(const ProgramMemory& memory) const {
  ORB360_CHECK(measures_times_);
  ORB360_CHECK(memory.IsOf(this), "a workspace of another executor");
  return static_cast<const CpuMemory&>(memory).times;
}

TensorView CpuProgram::Find(const ProgramMemory& memory, int value) const {
  ORB360_CHECK(memory.IsOf(this), "a workspace of another executor");
  return static_cast<const CpuMemory&>(memory).views[Index(value)];
}

std::vector<std::size_t> ScratchBytes(std::span<const Step> steps) {
  std::vector<std::size_t> bytes;
  bytes.reserve(steps.size());
  for (const Step& step : steps) bytes.push_back(step.scratch_bytes);
  return bytes;
}

}  // namespace orb360::nn
