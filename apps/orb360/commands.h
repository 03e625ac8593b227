#pragma once

#include <cmath>
#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include <orb360/nn/graph/device.h>
#include <orb360/nn/graph/precision.h>

namespace orb360 {

/// The work of a subcommand after the command line has been parsed. Returns the exit status of the
/// program.
using Command = std::function<int()>;

/// Refuses an option's value `nan`, which lies within every CLI::Range because no comparison with
/// it is true.
inline const CLI::Validator kIsNumber(
    [](const std::string& text) -> std::string {
      double value = 0;
      const bool is_nan = CLI::detail::lexical_cast(text, value) && std::isnan(value);
      return is_nan ? "Value " + text + " is not a number" : "";
    },
    "");

/// The processor of the network, as nn::OpenDevice takes it, and in which type the CPU multiplies.
struct DeviceOptions {
  std::string name = "cpu";
  bool uses_halves = false;
  nn::Precision precision = nn::Precision::kAuto;

  /// Opens the processor. Throws UserError where it cannot be used.
  nn::Device Open() const;
};

/// Returns the warning about Device::passed_over. Contract: it is not empty.
std::string PassedOverWarning(const nn::Device& device);

/// Adds the options for it.
void AddDeviceOptions(CLI::App* command, DeviceOptions* device);

/// Each of these adds a subcommand with its options to `app`. When the user chooses the subcommand,
/// `*chosen` receives the command to run.
void AddRunCommand(CLI::App* app, Command* chosen);
void AddEvaluateCommand(CLI::App* app, Command* chosen);
void AddFuseCommand(CLI::App* app, Command* chosen);
void AddGeoreferenceCommand(CLI::App* app, Command* chosen);
void AddExportCommand(CLI::App* app, Command* chosen);
void AddCalibrateCommand(CLI::App* app, Command* chosen);
void AddConfigCommand(CLI::App* app, Command* chosen);
void AddDevicesCommand(CLI::App* app, Command* chosen);
void AddCompleteCommand(CLI::App* app, Command* chosen);
void AddWeightsCommand(CLI::App* app, Command* chosen);
void AddViewCommand(CLI::App* app, Command* chosen);
void AddReportCommand(CLI::App* app, Command* chosen);

}  // namespace orb360
