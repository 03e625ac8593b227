// orb360, the command line. Results and progress go to standard output, warnings and the one line
// of an error to standard error.

#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core/utils/logger.hpp>

extern "C" {
#include <libavutil/log.h>
}

#include "apps/orb360/commands.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/version.h>

namespace {

constexpr int kUserError = 1;
constexpr int kUsageError = 2;      // as in shells and most tools
constexpr int kInternalError = 70;  // EX_SOFTWARE of sysexits.h

/// Returns the first line of CLI11's message and a hint at the help.
std::string UsageMessage(const CLI::App* app, const CLI::Error& error) {
  std::string what = error.what();
  what = what.substr(0, what.find('\n'));
  return "orb360: " + what + " (see orb360 " +
         (app->get_subcommands().empty() ? "" : app->get_subcommands().front()->get_name() + " ") +
         "--help)\n";
}

int Main(int argc, char** argv) {
  CLI::App app("Camera trajectory and map from 360-degree video");
  app.set_version_flag("--version", "orb360 " + std::string(orb360::Version()));
  app.require_subcommand(1);
  app.failure_message(UsageMessage);
  orb360::Command command;
  orb360::AddRunCommand(&app, &command);
  orb360::AddViewCommand(&app, &command);
  orb360::AddReportCommand(&app, &command);
  orb360::AddEvaluateCommand(&app, &command);
  orb360::AddFuseCommand(&app, &command);
  orb360::AddGeoreferenceCommand(&app, &command);
  orb360::AddExportCommand(&app, &command);
  orb360::AddCalibrateCommand(&app, &command);
  orb360::AddConfigCommand(&app, &command);
  orb360::AddCompleteCommand(&app, &command);
  orb360::AddWeightsCommand(&app, &command);
  orb360::AddDevicesCommand(&app, &command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? EXIT_SUCCESS : kUsageError;
  }
  return command();
}

}  // namespace

int main(int argc, char** argv) {
  // UserErrors report the files that OpenCV and FFmpeg cannot read, so their own messages are
  // switched off.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  av_log_set_level(AV_LOG_QUIET);
  // A closed pipe must not end a run whose results go to files.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return Main(argc, argv);
  } catch (const orb360::UserError& error) {
    std::cerr << "orb360: " << error.what() << '\n';
    return kUserError;
  } catch (const std::exception& error) {
    std::cerr << "orb360: internal error, please report it: " << error.what() << '\n';
    return kInternalError;
  }
}
