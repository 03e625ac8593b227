#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include <orb360/nn/graph/precision.h>

namespace orb360::nn {

/// The interface of a graph to the kernels of one kind of processor.
class Backend;

/// A device other than the CPU failed while a network was prepared or run: it was lost, or it has
/// too little memory. The same network can be run on the CPU. `what()` is one line that says what
/// happened on which device.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A processor on which networks run (OpenDevice).
struct Device {
  /// Its name for people, such as "cpu" or "vulkan:0 (NAME OF THE DEVICE)".
  std::string name = "cpu";
  /// What runs networks there; null for the CPU.
  std::shared_ptr<const Backend> backend = nullptr;
  /// In which type convolutions multiply where the CPU runs the network, also in the place of a
  /// device that has failed.
  Precision precision = Precision::kFloat;
  /// Where the name left the choice open: the graphics processors that were passed over, and why.
  /// Empty where there are none.
  std::string passed_over = {};
};

}  // namespace orb360::nn
