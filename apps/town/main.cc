#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <omp.h>
#include <unistd.h>

#include "apps/town/sequence/folder.h"
#include "apps/town/sequence/named_town.h"
#include "apps/town/sequence/statistics.h"
#include "apps/town/sequence/town_drive.h"
#include "slam/check.h"

namespace orb360::town {
namespace {

struct RenderArguments {
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
  int threads = 0;
};

/// A bar that is redrawn on a terminal, and a line now and then elsewhere.
class ProgressBar {
 public:
  explicit ProgressBar(int frames) : frames_(frames) {}

  void Show(int done, int rendered) {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double rate = seconds > 0 ? rendered / seconds : 0;
    const bool is_last = done == frames_;
    if (is_terminal_) {
      constexpr int kWidth = 40;
      const int filled = kWidth * done / frames_;
      const std::string bar = std::string(static_cast<size_t>(filled), '#') +
                              std::string(static_cast<size_t>(kWidth - filled), '.');
      std::fprintf(stderr, "\r[%s] frame %d of %d, %.1f frames/s%s", bar.c_str(), done, frames_,
                   rate, is_last ? "\n" : "");
    } else if (is_last || done % kLineEvery == 0) {
      std::fprintf(stderr, "frame %d of %d, %.1f frames/s\n", done, frames_, rate);
    }
  }

 private:
  static constexpr int kLineEvery = 100;

  int frames_;
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void Render(const RenderArguments& arguments) {
  TownSpec spec = FindTown(arguments.town);
  if (arguments.light) spec.light = *arguments.light;
  if (arguments.traffic) spec.traffic = *arguments.traffic;
  if (arguments.threads > 0) omp_set_num_threads(arguments.threads);
  constexpr double kDegree = std::numbers::pi / 180;
  spec.mount = {arguments.camera_height, arguments.pitch_degrees * kDegree,
                arguments.roll_degrees * kDegree, arguments.shaking};
  const TownDrive drive(spec, {EquirectangularCamera(arguments.width, arguments.width / 2),
                               arguments.fps, arguments.frames.value_or(spec.frames)});
  ProgressBar bar(drive.frames());
  const FolderOptions options{arguments.depth_every, arguments.masks};
  RenderIntoFolder(drive, arguments.out, options,
                   [&bar](int done, int rendered) { bar.Show(done, rendered); });
}

struct DescribeArguments {
  std::vector<std::string> towns;
  int every = 50;
};

/// Prints what drives are like.
void Describe(const DescribeArguments& arguments) {
  constexpr int kSought = 2000;
  std::vector<DriveStatistics> statistics;
  for (const std::string& name : arguments.towns) {
    const TownSpec spec = FindTown(name);
    const TownDrive drive(spec, {EquirectangularCamera(1024, 512), 20, spec.frames});
    statistics.push_back(MeasureDrive(drive, arguments.every, kSought));
  }
  std::fputs(StatisticsTable(arguments.towns, statistics).c_str(), stdout);
}

}  // namespace
}  // namespace orb360::town

int main(int argc, char** argv) {
  CLI::App app("Renders panoramic drives through procedural towns, with exact depth and poses.");
  app.require_subcommand(1);
  orb360::town::RenderArguments arguments;
  CLI::App* render = app.add_subcommand("render", "Render a sequence into a folder");
  render->add_option("--town", arguments.town, "Town1 ... Town5, Loop, or a seed")->required();
  render
      ->add_option("--out", arguments.out,
                   "Folder to write; an interrupted rendering there is resumed")
      ->required();
  render
      ->add_option("--frames", arguments.frames,
                   "Number of frames [the town's own; 600 for a seed]")
      ->check(CLI::Range(1, 1000000));
  render
      ->add_option("--width", arguments.width,
                   "Width of the panorama in pixels; its height is half of it")
      ->capture_default_str()
      ->check(CLI::Range(32, 16384));
  render->add_option("--fps", arguments.fps, "Frames per second")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1000.0));
  render->add_option("--light", arguments.light,
                     "noon, morning, sunset or overcast [the town's own; noon for a seed]");
  render
      ->add_option("--traffic", arguments.traffic,
                   "Density of what moves, 0 to 1 [the town's own; 0 for a seed]")
      ->check(CLI::Range(0.0, 1.0));
  render->add_option("--depth-every", arguments.depth_every, "Write the depth of every n-th frame")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  render->add_flag("--masks", arguments.masks,
                   "With the depth, write objects/ (16-bit ids) and moving/ (255 where it moves)");
  render
      ->add_option("--camera-height", arguments.camera_height,
                   "Metres above the road [drawn from the seed, 1.8 to 2.2]")
      ->check(CLI::Range(0.2, 10.0));
  render
      ->add_option("--camera-pitch", arguments.pitch_degrees,
                   "Degrees that the camera is tilted nose up")
      ->capture_default_str()
      ->check(CLI::Range(-90.0, 90.0));
  render
      ->add_option("--camera-roll", arguments.roll_degrees,
                   "Degrees that the camera is tilted left side up")
      ->capture_default_str()
      ->check(CLI::Range(-180.0, 180.0));
  render
      ->add_option("--shaking", arguments.shaking,
                   "Factor on vibration, and on leaning when braking and in bends")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10.0));
  render->add_option("--threads", arguments.threads, "Threads to use; 0: all cores")
      ->capture_default_str()
      ->check(CLI::Range(0, 256));
  orb360::town::DescribeArguments described;
  CLI::App* describe = app.add_subcommand(
      "describe", "Print speeds, turns, revisits, ranges and corners of drives as a table");
  describe->add_option("TOWN", described.towns, "Town1 ... Town5, Loop, or a seed")->required();
  describe
      ->add_option("--every", described.every,
                   "Look for ranges and corners in every n-th frame, rendered at 1024x512")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  CLI11_PARSE(app, argc, argv);
  try {
    if (render->parsed()) orb360::town::Render(arguments);
    if (describe->parsed()) orb360::town::Describe(described);
  } catch (const orb360::UserError& error) {
    std::fprintf(stderr, "town: %s\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "town: internal error: %s\n", error.what());
    return 2;
  }
  return 0;
}
