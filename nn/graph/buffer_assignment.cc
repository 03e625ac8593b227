#include "nn/graph/buffer_assignment.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

/// A value that is not part of another one, with its parts.
struct Whole {
  int halo = 0;
  Lifetime life{0, std::numeric_limits<int>::max(), -1};
};

class BufferAssigner {
 public:
  BufferAssigner(const Lowered& lowered, std::span<const std::size_t> scratch_bytes,
                 bool keeps_values)
      : lowered_(lowered),
        scratch_bytes_(scratch_bytes),
        keeps_values_(keeps_values),
        whole_of_(lowered.values.size()),
        first_channel_(lowered.values.size()),
        wholes_(lowered.values.size()),
        piece_of_(lowered.values.size()) {}

  BufferAssignment Run() {
    FindWholes();
    FindLifetimes();
    std::iota(piece_of_.begin(), piece_of_.end(), 0);
    if (!keeps_values_) ReplaceInputs();
    return Pack();
  }

 private:
  const Value& value(int index) const { return lowered_.values[Index(index)]; }
  Whole& WholeOf(int index) { return wholes_[Index(whole_of_[Index(index)])]; }

  void FindWholes() {
    for (std::size_t i = 0; i < lowered_.values.size(); ++i) {
      int whole = static_cast<int>(i);
      int first = 0;
      while (value(whole).whole >= 0) {
        first += value(whole).first_channel;
        whole = value(whole).whole;
      }
      whole_of_[i] = whole;
      first_channel_[i] = first;
      int& halo = wholes_[Index(whole)].halo;
      halo = std::max(halo, lowered_.values[i].format.halo);
    }
  }

  /// Steps are counted from 1. Inputs are written at step 0; outputs are read after the last step.
  void FindLifetimes() {
    const auto needed_at = [&](int index, int step) {
      Lifetime& life = WholeOf(index).life;
      life.first = std::min(life.first, step);
      life.last = std::max(life.last, step);
    };
    for (const int input : lowered_.inputs) needed_at(input, 0);
    int step = 0;
    for (const Instruction& instruction : lowered_.instructions) {
      ++step;
      for (const int input : instruction.inputs) needed_at(input, step);
      for (const int output : instruction.outputs) needed_at(output, step);
    }
    for (const int output : lowered_.outputs) needed_at(output, step + 1);
    if (!keeps_values_) return;
    for (Whole& whole : wholes_) whole.life.last = step + 1;
  }

  int Piece(int whole) const {
    while (piece_of_[Index(whole)] != whole) whole = piece_of_[Index(whole)];
    return whole;
  }

  void ReplaceInputs() {
    int step = 0;
    for (const Instruction& instruction : lowered_.instructions) {
      ++step;
      for (const int candidate : instruction.replaceable) {
        const int input = instruction.inputs[Index(candidate)];
        if (!CanReplace(instruction, input, step)) continue;
        const int output = instruction.outputs.front();
        const int piece = Piece(input);
        piece_of_[Index(output)] = piece;
        wholes_[Index(piece)].life.last = wholes_[Index(output)].life.last;
        int& halo = wholes_[Index(piece)].halo;
        halo = std::max(halo, wholes_[Index(output)].halo);
        break;
      }
    }
  }

  bool CanReplace(const Instruction& instruction, int input, int step) {
    const int output = instruction.outputs.front();
    TensorFormat from = value(input).format;
    TensorFormat to = value(output).format;
    from.halo = to.halo = 0;
    const bool are_alike =
        from.shape == to.shape && from.layout == to.layout && from.type == to.type;
    // Both values must be wholes; the one is last used, and the other first used, at this step.
    if (!are_alike || whole_of_[Index(input)] != input || whole_of_[Index(output)] != output ||
        wholes_[Index(Piece(input))].life.last != step ||
        wholes_[Index(output)].life.first != step || Piece(output) != output) {
      return false;
    }
    // Other inputs must not be overwritten before they are read, unless they are read at the same
    // position.
    for (std::size_t i = 0; i < instruction.inputs.size(); ++i) {
      const bool is_replaceable = std::ranges::find(instruction.replaceable, static_cast<int>(i)) !=
                                  instruction.replaceable.end();
      const int other = whole_of_[Index(instruction.inputs[i])];
      if (!is_replaceable && Piece(other) == Piece(input)) return false;
    }
    return true;
  }

  BufferAssignment Pack() {
    BufferAssignment assignment;
    std::vector<std::size_t> piece_number(wholes_.size());
    for (std::size_t i = 0; i < wholes_.size(); ++i) {
      const auto index = static_cast<int>(i);
      if (whole_of_[i] != index) continue;
      TensorFormat format = value(index).format;
      format.halo = wholes_[i].halo;
      assignment.separate_bytes += format.bytes();
      if (piece_of_[i] != index) continue;
      Lifetime life = wholes_[i].life;
      life.bytes = format.bytes();
      piece_number[i] = assignment.pieces.size();
      assignment.pieces.push_back(life);
    }
    const std::size_t first_scratch = assignment.pieces.size();
    int step = 0;
    for (const std::size_t bytes : scratch_bytes_) {
      ++step;
      assignment.pieces.push_back({bytes, step, step});
      assignment.separate_bytes += bytes;
    }
    MemoryPlan plan = PlanMemory(assignment.pieces);
    assignment.scratch.assign(plan.offsets.begin() + static_cast<std::ptrdiff_t>(first_scratch),
                              plan.offsets.end());
    for (std::size_t i = 0; i < lowered_.values.size(); ++i) {
      const int whole = whole_of_[i];
      const int piece = Piece(whole);
      TensorFormat format = value(whole).format;
      format.halo = wholes_[Index(piece)].halo;
      assignment.buffers.push_back(
          {format, plan.offsets[piece_number[Index(piece)]], first_channel_[i]});
    }
    assignment.offsets = std::move(plan.offsets);
    assignment.bytes = plan.bytes;
    return assignment;
  }

  const Lowered& lowered_;
  const std::span<const std::size_t> scratch_bytes_;  // by instruction
  const bool keeps_values_;
  std::vector<int> whole_of_;       // by value
  std::vector<int> first_channel_;  // by value, of its whole
  std::vector<Whole> wholes_;       // by value; of those that are whole
  std::vector<int> piece_of_;       // by whole: the one whose memory it takes over, or itself
};

}  // namespace

BufferAssignment AssignBuffers(const Lowered& lowered, std::span<const std::size_t> scratch_bytes,
                               bool keeps_values) {
  ORB360_CHECK(scratch_bytes.size() == lowered.instructions.size(), scratch_bytes.size());
  return BufferAssigner(lowered, scratch_bytes, keeps_values).Run();
}

TensorView ViewOf(const BufferAssignment::Buffer& buffer, int channels, std::byte* memory) {
  return ChannelSlice(buffer.whole.View(memory + buffer.offset), buffer.first_channel, channels);
}

}  // namespace orb360::nn
