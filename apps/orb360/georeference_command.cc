#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "apps/orb360/commands.h"
#include "apps/orb360/finished_run.h"
#include "apps/orb360/run_positions.h"
#include "slam/io/positions/read_positions.h"

namespace orb360 {
namespace {

struct GeoreferenceOptions {
  std::string run;
  PositionOptions positions;
  bool is_quiet = false;
};

int RunGeoreference(const GeoreferenceOptions& options) {
  const std::optional<double> utc_start = ParseUtcStart(options.positions);
  const FinishedRun run = OpenFinishedRun(options.run);
  const PositionTrack track = ReadPositions(options.positions.file, run.summary.fps);
  const Georeference georeference = PlaceLargestMap(
      run.model, track,
      {UpOfLargestMap(run.model, run.summary.is_levelled), run.summary.scale, utc_start});
  WriteGeoreference(run.folder / kGeoreferenceName, georeference);
  if (!options.is_quiet) {
    std::cout << StatePositions(DescribePositions(track, &georeference, "")) << "\nwrote "
              << (run.folder / kGeoreferenceName).string() << std::endl;
  }
  return EXIT_SUCCESS;
}

}  // namespace

void AddGeoreferenceCommand(CLI::App* app, Command* chosen) {
  CLI::App* command =
      app->add_subcommand("georeference", "Place a finished run on Earth by positions");
  const auto options = std::make_shared<GeoreferenceOptions>();
  command->add_option("RUN", options->run, "Folder of a run")->required()->type_name("DIR");
  command
      ->add_option("--positions", options->positions.file,
                   "Where the camera was: a GPX file, or a video or images with positions")
      ->required()
      ->type_name("FILE");
  AddUtcStartOption(command, &options->positions);
  command->add_flag("--quiet", options->is_quiet, "Print nothing");
  command->callback(
      [options, chosen] { *chosen = [options] { return RunGeoreference(*options); }; });
}

}  // namespace orb360
