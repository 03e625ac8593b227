#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "apps/orb360/commands.h"
#include "apps/orb360/run_positions.h"
#include <orb360/slam/io/sequence.h>

namespace orb360 {

/// The command line of `orb360 run`.
struct RunOptions {
  std::string input;
  std::string out;
  std::string config;
  std::string mask = "auto";
  int threads = 0;           // 0: one for each core
  double camera_height = 0;  // metres; 0: as the configuration or the input says
  std::string resize;
  std::string map_in;
  std::string map_out;
  bool localizes = false;
  std::string loops = "on";
  SequenceOptions sequence;
  PositionOptions positions;
  std::string weights;
  DeviceOptions device;
  bool saves_sparse = false;
  bool saves_depth = false;
  bool saves_views = false;
  bool has_mesh = false;
  std::string cloud_quality;  // "": as the configuration says
  std::string view_port;      // "": the run is not shown
  std::string view_address = "127.0.0.1";
  bool is_quiet = false;
};

/// Adds them to the command.
void AddRunOptions(CLI::App* command, RunOptions* options);

/// Completes options that were left open, and refuses what cannot be done, before any work.
RunOptions Settle(RunOptions options);

/// Returns the size that --resize asks for; empty for "". Throws UserError for what is no size of a
/// full sphere.
cv::Size ParseSize(const std::string& text);

}  // namespace orb360
