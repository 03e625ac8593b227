#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <omp.h>

#include "apps/town/commands.h"
#include "apps/town/progress_bar.h"
#include "apps/town/sequence/named_town.h"
#include "apps/town/sequence/render_folder.h"
#include "apps/town/sequence/town_drive.h"

namespace orb360::town {
namespace {

struct Arguments {
  std::string town;
  std::filesystem::path out;
  std::optional<int> frames;
  int width = 1024;
  double fps = 20;
  std::optional<std::string> light;
  std::optional<double> traffic;
  int depth_every = 1;
  bool masks = false;
  double pitch_degrees = 0;
  double roll_degrees = 0;
  std::optional<double> camera_height;
  double shaking = 1;
  int cube = 0;
  int threads = 0;
};

void Render(const Arguments& arguments) {
  TownSpec spec = FindTown(arguments.town);
  if (arguments.light) spec.light = *arguments.light;
  if (arguments.traffic) spec.traffic = *arguments.traffic;
  if (arguments.threads > 0) omp_set_num_threads(arguments.threads);
  constexpr double kDegree = std::numbers::pi / 180;
  spec.mount = {arguments.camera_height, arguments.pitch_degrees * kDegree,
                arguments.roll_degrees * kDegree, arguments.shaking};
  const TownDrive drive(spec,
                        {EquirectangularCamera(arguments.width, arguments.width / 2), arguments.fps,
                         arguments.frames.value_or(spec.frames), arguments.cube});
  ProgressBar bar;
  const FolderOptions options{arguments.depth_every, arguments.masks};
  RenderIntoFolder(drive, arguments.out, options,
                   [&](int done, int rendered) { bar.Show(done, rendered, drive.frames()); });
}

}  // namespace

void AddRenderCommand(CLI::App* app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app->add_subcommand("render", "Render a sequence into a folder");
  command->add_option("--town", arguments->town, "Town1 ... Town5, Loop, or a seed")->required();
  command
      ->add_option("--out", arguments->out,
                   "Folder to write; an interrupted rendering there is resumed")
      ->required();
  command
      ->add_option("--frames", arguments->frames,
                   "Number of frames [the town's own; 600 for a seed]")
      ->check(CLI::Range(1, 1000000));
  command
      ->add_option("--width", arguments->width,
                   "Width of the panorama in pixels; its height is half of it")
      ->capture_default_str()
      ->check(CLI::Range(32, 16384));
  command
      ->add_option("--cube", arguments->cube,
                   "Stitch the panorama from six faces, so many pixels wide; 0: render it directly")
      ->capture_default_str()
      ->check(CLI::Range(0, 8192));
  command->add_option("--fps", arguments->fps, "Frames per second")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1000.0));
  command->add_option("--light", arguments->light,
                      "noon, morning, sunset or overcast [the town's own; noon for a seed]");
  command
      ->add_option("--traffic", arguments->traffic,
                   "Density of what moves, 0 to 1 [the town's own; 0 for a seed]")
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--depth-every", arguments->depth_every, "Write the depth of every n-th frame")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--masks", arguments->masks,
                    "With the depth, write objects/ (16-bit ids) and moving/ (255 where it moves)");
  command
      ->add_option("--camera-height", arguments->camera_height,
                   "Metres above the road [drawn from the seed, 1.8 to 2.2]")
      ->check(CLI::Range(0.2, 10.0));
  command
      ->add_option("--camera-pitch", arguments->pitch_degrees,
                   "Degrees that the camera is tilted nose up")
      ->capture_default_str()
      ->check(CLI::Range(-90.0, 90.0));
  command
      ->add_option("--camera-roll", arguments->roll_degrees,
                   "Degrees that the camera is tilted left side up")
      ->capture_default_str()
      ->check(CLI::Range(-180.0, 180.0));
  command
      ->add_option("--shaking", arguments->shaking,
                   "Factor on vibration, and on leaning when braking and in bends")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10.0));
  command->add_option("--threads", arguments->threads, "Threads to use; 0: all cores")
      ->capture_default_str()
      ->check(CLI::Range(0, 256));
  command->callback([arguments] { Render(*arguments); });
}

}  // namespace orb360::town
