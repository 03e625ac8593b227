#pragma once

#include <cmath>
#include <functional>
#include <string>

#include <CLI/CLI.hpp>

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

/// The processor of the network, as nn::OpenDevice takes it.
struct DeviceOptions {
  std::string name = "cpu";
  bool uses_halves = false;
};

/// Adds the options for it.
inline void AddDeviceOptions(CLI::App* command, DeviceOptions* device) {
  command
      ->add_option("--device", device->name,
                   "Processor of the network: cpu; auto, the first GPU or else the CPU; vulkan or "
                   "vulkan:N, a device of `orb360 devices`")
      ->type_name("cpu|auto|vulkan[:N]")
      ->capture_default_str();
  command->add_flag("--float16", device->uses_halves,
                    "Keep results of convolutions as 16-bit floats on a GPU: less traffic of its "
                    "memory, and less exact");
}

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
