#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <omp.h>

#include "apps/town/commands.h"
#include "apps/town/option_checks.h"
#include "apps/town/progress_bar.h"
#include "apps/town/sequence/imported_drive.h"
#include "apps/town/sequence/interior_drive.h"
#include "apps/town/sequence/named_town.h"
#include "apps/town/sequence/render_folder.h"
#include "apps/town/sequence/seed.h"
#include "apps/town/sequence/sequence_writer.h"
#include "apps/town/sequence/town_drive.h"
#include "apps/town/sequence/walk_drive.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

struct Arguments {
  std::string town;
  std::string interior;
  std::string landscape;
  std::string tunnel;
  ImportedSpec imported;
  std::filesystem::path out;
  std::optional<int> frames;
  std::optional<int> width;
  double fps = 20;
  std::optional<std::string> light;
  std::optional<double> traffic;
  int depth_every = 1;
  bool exr = false;
  bool masks = false;
  double pitch_degrees = 0;
  double roll_degrees = 0;
  std::optional<double> camera_height;
  double shaking = 1;
  std::optional<int> cube;
  Sampling sampling = Sampling::kAdaptive;
  std::optional<double> shutter;
  std::optional<int> jpeg_quality;
  bool auto_exposure = false;
  bool dual_lens = false;
  bool noise = false;
  int threads = 0;
};

constexpr double kDegree = std::numbers::pi / 180;
// Of worlds that are no towns, unless the user states them.
constexpr int kWidth = 1024;
constexpr int kFrames = 1200;  // a minute at 20 a second

SensorOptions SensorOf(const Arguments& arguments) {
  SensorOptions sensor;
  if (arguments.auto_exposure) sensor.auto_exposure = AutoExposure();
  if (arguments.shutter) sensor.motion_blur = MotionBlur{.shutter = *arguments.shutter};
  if (arguments.dual_lens) sensor.dual_lens = DualLens();
  if (arguments.noise) sensor.noise = SensorNoise();
  sensor.jpeg_quality = arguments.jpeg_quality;
  return sensor;
}

Mount MountOf(const Arguments& arguments) {
  return {arguments.camera_height, arguments.pitch_degrees * kDegree,
          arguments.roll_degrees * kDegree, arguments.shaking};
}

/// Returns the recording. `width` and `cube_size` are used if the user does not state the size.
Recording RecordingOf(const Arguments& arguments, int width, int cube_size) {
  const int chosen = arguments.width.value_or(width);
  Recording recording{EquirectangularCamera(chosen, chosen / 2), arguments.fps};
  recording.cube_size = arguments.cube.value_or(arguments.width ? 0 : cube_size);
  recording.sensor = SensorOf(arguments);
  recording.sampling = arguments.sampling;
  return recording;
}

std::unique_ptr<Drive> MakeTownDrive(const Arguments& arguments) {
  TownSpec spec = FindTown(arguments.town);
  Recording recording = RecordingOf(arguments, spec.width, spec.cube_size);
  if (arguments.light) spec.light = *arguments.light;
  if (arguments.traffic) spec.traffic = *arguments.traffic;
  spec.mount = MountOf(arguments);
  recording.frames = arguments.frames.value_or(spec.frames);
  recording.sensor.seed = spec.seed;
  return std::make_unique<TownDrive>(spec, recording);
}

/// Prints what is wrong in one line, unless the list is empty.
void Warn(const std::string& consequence, const std::vector<std::string>& problems) {
  if (problems.empty()) return;
  std::string all;
  for (const std::string& problem : problems) {
    all += all.empty() ? "" : "; ";
    all += problem;
  }
  std::fprintf(stderr, "town: warning: %s (%zu): %s\n", consequence.c_str(), problems.size(),
               all.c_str());
}

std::unique_ptr<Drive> MakeInteriorDrive(const Arguments& arguments) {
  InteriorSpec spec;
  spec.seed = RequireSeed("interior", arguments.interior);
  Recording recording = RecordingOf(arguments, kWidth, 0);
  spec.light = arguments.light;
  spec.mount = MountOf(arguments);
  recording.frames = arguments.frames.value_or(kFrames);
  recording.sensor.seed = spec.seed;
  return std::make_unique<InteriorDrive>(spec, recording);
}

std::unique_ptr<Drive> MakeWalkDrive(const Arguments& arguments) {
  WalkSpec spec;
  if (arguments.tunnel.empty()) {
    spec.seed = RequireSeed("landscape", arguments.landscape);
  } else {
    if (arguments.light) throw UserError("--light is for worlds under a sky: a --tunnel has none");
    spec.world = WalkSpec::World::kTunnel;
    spec.seed = RequireSeed("tunnel", arguments.tunnel);
  }
  Recording recording = RecordingOf(arguments, kWidth, 0);
  spec.light = arguments.light;
  spec.mount = MountOf(arguments);
  recording.frames = arguments.frames.value_or(kFrames);
  recording.sensor.seed = spec.seed;
  return std::make_unique<WalkDrive>(spec, recording);
}

std::unique_ptr<Drive> MakeImportedDrive(const Arguments& arguments) {
  Recording recording = RecordingOf(arguments, kWidth, 0);
  ImportedSpec spec = arguments.imported;
  if (spec.path.empty()) throw UserError("--scene needs a --path through it");
  if (arguments.light) spec.light = *arguments.light;
  const CameraPath path = ReadCameraPath(spec.path);
  // A thousandth of a frame is added, because times in files are rounded.
  const int whole = static_cast<int>((path.end() - path.begin()) * recording.fps + 1e-3) + 1;
  recording.frames = arguments.frames.value_or(whole);
  if (recording.frames > whole) {
    throw UserError(spec.path.string() + ": the path ends after " + std::to_string(whole) +
                    " frames: ask for no more with --frames");
  }
  auto drive = std::make_unique<ImportedDrive>(spec, path, recording);
  Warn("grey stands for textures", drive->missing_textures());
  Warn("decorations are left out", drive->missing_decorations());
  return drive;
}

using DriveMaker = std::unique_ptr<Drive> (*)(const Arguments&);

void Render(const Arguments& arguments) {
  const std::array<std::pair<bool, DriveMaker>, 5> worlds = {
      {{!arguments.town.empty(), MakeTownDrive},
       {!arguments.interior.empty(), MakeInteriorDrive},
       {!arguments.landscape.empty(), MakeWalkDrive},
       {!arguments.tunnel.empty(), MakeWalkDrive},
       {!arguments.imported.scene.empty(), MakeImportedDrive}}};
  const auto is_chosen = [](const auto& world) { return world.first; };
  if (std::ranges::count_if(worlds, is_chosen) != 1)
    throw UserError(
        "render takes one of --town, --interior, --landscape, --tunnel and --scene "
        "(see town render --help)");
  if (arguments.imported.scene.empty() && !arguments.imported.path.empty())
    throw UserError("--path is for a --scene: other worlds have paths of their own");
  if (arguments.town.empty() && arguments.traffic)
    throw UserError("--traffic is for a --town: nothing moves in other worlds");
  RequireWritable(arguments.out);
  if (arguments.threads > 0) omp_set_num_threads(arguments.threads);
  const std::unique_ptr<Drive> drive = std::ranges::find_if(worlds, is_chosen)->second(arguments);
  ProgressBar bar;
  const FolderOptions options{arguments.depth_every, arguments.exr, arguments.masks};
  RenderIntoFolder(*drive, arguments.out, options,
                   [&](int done, int rendered) { bar.Show(done, rendered, drive->frames()); });
}

void AddSceneOptions(CLI::App* command, Arguments* arguments) {
  ImportedSpec& imported = arguments->imported;
  command->add_option("--town", arguments->town, "Town1 ... Town5, Loop, or a seed");
  command->add_option("--interior", arguments->interior,
                      "Instead of a town: the rooms of a building, by a seed");
  command->add_option("--landscape", arguments->landscape,
                      "Instead of a town: a trail through woods, heath or rocks, by a seed");
  command->add_option("--tunnel", arguments->tunnel,
                      "Instead of a town: a mine, a cave, a road tunnel or a culvert, by a seed");
  command->add_option(
      "--scene", imported.scene,
      "Instead of a town: a file of textured meshes (OBJ, glTF, AC3D, Quake's BSP, ...)");
  command->add_option(
      "--path", imported.path,
      "The camera's path through the scene: lines `time x y z [qx qy qz qw]`, z up, "
      "in metres");
  command->add_option("--scale", imported.options.scale, "Metres that a unit of the scene is")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e6));
  command->add_option("--up", imported.options.up, "Axis of the scene's file that points up")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, UpAxis>{{"y", UpAxis::kY}, {"z", UpAxis::kZ}}))
      ->default_str("y");
  command->add_option("--textures", imported.options.texture_folders,
                      "Folders with textures besides that of the scene");
  command->add_option(
      "--light", arguments->light,
      "noon, morning, sunset or overcast [the town's own; noon for a seed; drawn from "
      "the seed indoors and in landscapes; none in tunnels]");
  command
      ->add_option("--traffic", arguments->traffic,
                   "Density of what moves, 0 to 1 [the town's own; 0 for a seed]")
      ->check(CLI::Range(0.0, 1.0));
}

void AddImageOptions(CLI::App* command, Arguments* arguments) {
  command
      ->add_option("--out", arguments->out,
                   "Folder to write; an interrupted rendering there is resumed")
      ->required();
  command
      ->add_option("--frames", arguments->frames,
                   "Number of frames [the town's own; 600 for a seed; 1200 in other worlds; "
                   "the whole path of a scene]")
      ->check(CLI::Range(1, 1000000));
  command
      ->add_option("--width", arguments->width,
                   "Width of the panorama in pixels; its height is half of it [2048 for Town1 ... "
                   "Town5, 1024 for others]")
      ->check(CLI::Range(32, 16384) & EvenNumber());
  command
      ->add_option("--cube", arguments->cube,
                   "Stitch the panorama from six faces, so many pixels wide; 0: render it directly "
                   "[768 for Town1 ... Town5 without --width, else 0]")
      ->check(CLI::Range(0, 0) | CLI::Range(16, 8192));
  command
      ->add_option(
          "--samples", arguments->sampling,
          "Rays for a pixel: adaptive (one, and four where surfaces or shadows meet), or 4 "
          "everywhere, which takes longer")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Sampling>{
          {"adaptive", Sampling::kAdaptive}, {"4", Sampling::kFull}}))
      ->default_str("adaptive");
  command->add_option("--fps", arguments->fps, "Frames per second")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 1000.0));
  command
      ->add_option("--depth-every", arguments->depth_every, "Write the depth of every n-th frame")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--exr", arguments->exr,
                    "With the depth, write range/ (the same as 32-bit floats, OpenEXR)");
  command->add_flag("--masks", arguments->masks,
                    "With the depth, write objects/ (16-bit ids) and moving/ (255 where it moves)");
}

void AddCameraOptions(CLI::App* command, Arguments* arguments) {
  command
      ->add_option("--camera-height", arguments->camera_height,
                   "Metres above the road or the floor [drawn from the seed, 1.8 to 2.2; on foot "
                   "0.3 to 2.2]")
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
  command->add_flag("--auto-exposure", arguments->auto_exposure,
                    "Expose for the light, in steps of a third of a stop");
  command
      ->add_option("--motion-blur", arguments->shutter,
                   "Seconds that the shutter is open; rendering takes four times as long")
      ->check(CLI::Range(1e-5, 1.0));
  command->add_flag("--dual-lens", arguments->dual_lens,
                    "Show seams as of two fisheye lenses back to back");
  command->add_flag("--noise", arguments->noise, "Add the noise of a small sensor");
  command
      ->add_option("--jpeg-quality", arguments->jpeg_quality,
                   "Compress images as a camera does, before they are stored at 95")
      ->check(CLI::Range(1, 100));
}

}  // namespace

void AddRenderCommand(CLI::App* app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app->add_subcommand("render", "Render a sequence into a folder");
  AddSceneOptions(command, arguments.get());
  AddImageOptions(command, arguments.get());
  AddCameraOptions(command, arguments.get());
  command->add_option("--threads", arguments->threads, "Threads to use; 0: all cores")
      ->capture_default_str()
      ->check(CLI::Range(0, 256));
  command->callback([arguments] { Render(*arguments); });
}

}  // namespace orb360::town
