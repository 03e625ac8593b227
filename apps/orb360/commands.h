#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace orb360 {

/// The work of a subcommand after the command line has been parsed. Returns the exit status of the
/// program.
using Command = std::function<int()>;

/// Each of these adds a subcommand with its options to `app`. When the user chooses the subcommand,
/// `*chosen` receives the command to run.
void AddRunCommand(CLI::App* app, Command* chosen);
void AddEvaluateCommand(CLI::App* app, Command* chosen);
void AddConfigCommand(CLI::App* app, Command* chosen);
void AddCompleteCommand(CLI::App* app, Command* chosen);
void AddWeightsCommand(CLI::App* app, Command* chosen);

}  // namespace orb360
