#include <filesystem>
#include <memory>

#include "apps/town/commands.h"
#include "apps/town/option_checks.h"
#include "apps/town/progress_bar.h"
#include "apps/town/sequence/sequence_writer.h"
#include "apps/town/sequence/stitch_folder.h"

namespace orb360::town {

void AddStitchCommand(CLI::App* app) {
  struct Arguments {
    std::filesystem::path recording;
    std::filesystem::path out;
    StitchOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  StitchOptions& options = arguments->options;
  CLI::App* command =
      app->add_subcommand("stitch", "Make a sequence of panoramas from a recording by six cameras");
  command
      ->add_option("RECORDING", arguments->recording,
                   "Folder with front/, right/, back/, left/, up/ and down/, and optionally "
                   "depth_front/ ... and groundtruth.txt")
      ->required();
  command
      ->add_option("--out", arguments->out, "Folder to write; an interrupted job there is resumed")
      ->required();
  command->add_option("--width", options.width, "Width of the panorama; its height is half of it")
      ->capture_default_str()
      ->check(CLI::Range(32, 16384) & EvenNumber());
  command->add_option("--fps", options.fps, "Frames per second of the recording")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e6));
  command
      ->add_option("--camera-height", options.camera_height,
                   "Metres of the camera above the road, if known")
      ->check(CLI::Range(0.01, 1000.0));
  command
      ->add_option("--farthest-depth", options.farthest_depth,
                   "Metres that the largest number of 24-bit depth stands for")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e6));
  command->callback([arguments] {
    RequireWritable(arguments->out);
    ProgressBar bar;
    StitchFolder(arguments->recording, arguments->out, arguments->options,
                 [&bar](int done, int all) { bar.Show(done, done, all); });
  });
}

}  // namespace orb360::town
