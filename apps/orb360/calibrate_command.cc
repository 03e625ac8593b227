#include <iomanip>
#include <iostream>
#include <memory>
#include <numbers>
#include <string>

#include <CLI/CLI.hpp>

#include "apps/orb360/commands.h"
#include "slam/io/atomic_file.h"
#include "slam/io/lenses/calibrate_lenses.h"

namespace orb360 {
namespace {

struct CalibrateOptions {
  std::string input;
  std::string lens;
  std::string out;
};

int Calibrate(const CalibrateOptions& options) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const LensEstimate estimate = CalibrateLenses(options.input, FindLensCalibration(options.lens));
  WriteFileAtomically(options.out, ToYaml(estimate.calibration));
  std::cout << std::fixed << std::setprecision(2) << "both lenses agree to "
            << kDegrees * estimate.median_after << " degrees (median of " << estimate.num_matches
            << " places; before " << kDegrees * estimate.median_before << "); wrote " << options.out
            << std::endl;
  return EXIT_SUCCESS;
}

}  // namespace

void AddCalibrateCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand(
      "calibrate", "Find the calibration of two fisheye lenses from what both show");
  const auto options = std::make_shared<CalibrateOptions>();
  command->add_option("INPUT", options->input, "Video, or folder of images, of two fisheye lenses")
      ->required();
  command
      ->add_option("--lens", options->lens,
                   "Calibration to begin with, as for `orb360 run`: a file or a preset")
      ->type_name("FILE|PRESET")
      ->required();
  command->add_option("--out", options->out, "Calibration file to write")
      ->type_name("FILE")
      ->required();
  command->callback([options, chosen] { *chosen = [options] { return Calibrate(*options); }; });
}

}  // namespace orb360
