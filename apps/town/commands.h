#pragma once

#include <CLI/CLI.hpp>

namespace orb360::town {

/// Each function adds a subcommand that runs when the command line is parsed; it may throw
/// UserError.
void AddRenderCommand(CLI::App* app);
void AddStitchCommand(CLI::App* app);
void AddDescribeCommand(CLI::App* app);
void AddPathCommand(CLI::App* app);

}  // namespace orb360::town
