#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "slam/io/export/view.h"
#include "slam/io/sparse_model.h"

namespace orb360 {

/// The command line of `orb360 export`.
struct ExportOptions {
  std::string run;
  std::string format;
  std::string out;
  std::string input;   // "": as the run's summary says
  std::string lens;    // "": as the run's summary says
  std::string frames;  // "": as the format wants
  double spacing = 0.1;
  int map = -1;        // -1: the largest
  std::string images;  // "": jpg
  std::string views;   // "": as the format wants; of a format of trajectories it stays so
  double fov = 0;      // degrees; 0: 96
  std::string points;  // "": landmarks
  int max_points = 0;  // 0: all landmarks, or 500,000 of a cloud
  bool is_text = false;
  bool is_quiet = false;
};

/// Adds them to the command.
void AddExportOptions(CLI::App* command, ExportOptions* options);

/// Completes options that were left open as the format wants. Throws UserError for a format that
/// does not exist, and for what it cannot do.
ExportOptions Settle(ExportOptions options);

/// Whether a format has geographic coordinates only.
bool IsGeographic(const std::string& format);

/// Returns the cameras that the settled options ask for. Throws UserError for unknown ones.
std::vector<View> ViewsOf(const ExportOptions& options, const SparseModel& model);

}  // namespace orb360
