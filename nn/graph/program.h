#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// What a Program does beside computing outputs.
struct ProgramOptions {
  bool keeps_values = false;    ///< The result of every instruction remains (Program::Find).
  bool measures_times = false;  ///< Program::Times.
};

class Program;

/// What one run of a Program works in.
class ProgramMemory {
 public:
  /// `program` allocates it.
  explicit ProgramMemory(const Program* program) : program_(program) {}
  ProgramMemory(const ProgramMemory&) = delete;
  ProgramMemory& operator=(const ProgramMemory&) = delete;
  virtual ~ProgramMemory() = default;

  /// Whether it is what that program has allocated, and so of its kind and size.
  bool IsOf(const Program* program) const { return program == program_; }

 private:
  const Program* program_;  // only compared: it may not exist any more
};

/// A network prepared for one size of image on one kind of processor (Backend::MakeProgram). It
/// never changes, so any number of threads may run it at once, each with memory of its own.
class Program {
 public:
  Program() = default;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  virtual ~Program() = default;

  /// Throws UserError where there is too little memory, and DeviceError where a device has too
  /// little or fails. The result may outlive the program.
  virtual std::unique_ptr<ProgramMemory> Allocate() const = 0;
  /// Computes `outputs` from `inputs`, whose order and sizes are those of the graph. Throws
  /// ContractError for memory of another program, and DeviceError where a device fails.
  virtual void Run(std::span<const std::span<const float>> inputs,
                   std::span<const std::span<float>> outputs, ProgramMemory* memory) const = 0;
  /// Returns a value of Lowered::values after a run. Throws ContractError for memory of another
  /// program. Contract: made with `keeps_values`.
  virtual TensorView Find(const ProgramMemory& memory, int value) const = 0;

  /// Returns the milliseconds of the last run's copies of inputs, instructions and copies of
  /// outputs, in this order; nothing before the first run. Throws ContractError for memory of
  /// another program, and DeviceError where a device fails. Contract: made with `measures_times`.
  virtual std::vector<double> Times(const ProgramMemory& memory) const = 0;

  /// Bytes of the tensors and scratch of one run.
  virtual std::size_t planned_bytes() const = 0;
  /// The same if each had memory of its own.
  virtual std::size_t naive_bytes() const = 0;
};

}  // namespace orb360::nn
