#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "nn/graph/buffer_assignment.h"
#include "nn/graph/cpu_backend.h"
#include "nn/graph/lowering.h"
#include "nn/graph/program.h"

namespace orb360::nn {

/// The steps of a graph one after the other, in one block of memory.
class CpuProgram : public Program {
 public:
  /// `steps` by instruction.
  CpuProgram(Lowered lowered, std::vector<Step> steps, const ProgramOptions& options, int threads);

  std::unique_ptr<ProgramMemory> Allocate() const override;
  void Run(std::span<const std::span<const float>> inputs,
           std::span<const std::span<float>> outputs, ProgramMemory* memory) const override;
  TensorView Find(const ProgramMemory& memory, int value) const override;
  std::vector<double> Times(const ProgramMemory& memory) const override;
  std::size_t planned_bytes() const override { return assignment_.bytes; }
  std::size_t naive_bytes() const override { return assignment_.separate_bytes; }

 private:
  Lowered lowered_;
  std::vector<Step> steps_;
  BufferAssignment assignment_;
  bool measures_times_;
  int threads_;
};

/// Returns the bytes of scratch memory of each step.
std::vector<std::size_t> ScratchBytes(std::span<const Step> steps);

}  // namespace orb360::nn
