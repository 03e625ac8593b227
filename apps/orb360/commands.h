#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace orb360 {

/// What a subcommand does once the command line is parsed; gives the program's exit status.
using Command = std::function<int()>;

/// Each adds a subcommand with its options to `app`. When the user asks for it, `*chosen` becomes
/// the command to run.
void AddRunCommand(CLI::App* app, Command* chosen);
void AddEvaluateCommand(CLI::App* app, Command* chosen);
void AddConfigCommand(CLI::App* app, Command* chosen);
void AddCompleteCommand(CLI::App* app, Command* chosen);
void AddWeightsCommand(CLI::App* app, Command* chosen);

}  // namespace orb360
