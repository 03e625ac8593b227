#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <omp.h>

#include "apps/town/drive/camera_path.h"
#include "apps/town/image/random.h"
#include "apps/town/output/sequence_writer.h"
#include "apps/town/render/openness.h"
#include "apps/town/render/renderer.h"
#include "apps/town/world/town.h"
#include "slam/check.h"

namespace orb360::town {
namespace {

struct RenderArguments {
  std::string town;
  std::filesystem::path out;
  int frames = 600;
  int width = 1024;
  double fps = 20;
  std::string light = "noon";
  double traffic = 0;
  int depth_every = 1;
  int threads = 0;
};

uint64_t SeedOf(const std::string& town) {
  if (town.empty() || town.find_first_not_of("0123456789") != std::string::npos ||
      town.size() > 18) {
    throw UserError("unknown town '" + town +
                    "': give a seed (a whole number of at most 18 digits)");
  }
  return std::stoull(town);
}

void Render(const RenderArguments& arguments) {
  const uint64_t seed = SeedOf(arguments.town);
  if (arguments.threads > 0) omp_set_num_threads(arguments.threads);
  const Light light = MakeLight(arguments.light, seed);
  auto T=[t0=std::clock()](const char*w){std::fprintf(stderr,"%s %.2f\n",w,double(std::clock()-t0)/CLOCKS_PER_SEC);};  Town town = BuildTown(seed);T("town");std::fprintf(stderr,"%zu verts %zu tris %zu inst\n",town.fixed.vertices.size(),town.fixed.triangles.size(),town.instances.size());
  const Sky sky(light, seed);
  const RayScene scene(town);
  T("scene");BakeOpenness(scene, &town);T("bake");
  const Shader shader(town, light, sky);

  DriveOptions drive;
  drive.seed = Random(seed).Fork(50).Next();
  drive.frames = arguments.frames;
  drive.fps = arguments.fps;
  drive.camera_height = Random(seed).Fork(51).Uniform(1.8, 2.2);
  const std::vector<Rigid3> poses = DriveTour(town.plan, drive);

  const EquirectangularCamera camera(arguments.width, arguments.width / 2);
  SequenceInfo info;
  info.width = camera.width();
  info.height = camera.height();
  info.fps = arguments.fps;
  info.frames = arguments.frames;
  info.camera_height = drive.camera_height;
  info.town = arguments.town;
  info.seed = seed;
  info.light = light.name;
  info.traffic = arguments.traffic;
  for (size_t i = 1; i < poses.size(); ++i) {
    const double speed = (poses[i].translation - poses[i - 1].translation).norm() * arguments.fps;
    info.mean_speed += speed / static_cast<double>(poses.size() - 1);
    info.maximum_speed = std::max(info.maximum_speed, speed);
  }
  T("path");const SequenceWriter writer(arguments.out, info, poses);
  const auto start = std::chrono::steady_clock::now();
  for (int frame = 0; frame < arguments.frames; ++frame) {
    const Rigid3& pose = poses[static_cast<size_t>(frame)];
    writer.WriteColour(frame, RenderColour(scene, shader, camera, pose));
    if (frame % arguments.depth_every == 0)
      writer.WriteRange(frame, RenderRange(scene, camera, pose));
    T("frame");const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (frame % 20 == 19)
      std::fprintf(stderr, "frame %d of %d, %.1f frames/s\n", frame + 1, arguments.frames,
                   (frame + 1) / seconds);
  }
}

}  // namespace
}  // namespace orb360::town

int main(int argc, char** argv) {
  CLI::App app("Renders panoramic drives through procedural towns, with exact depth and poses.");
  app.require_subcommand(1);
  orb360::town::RenderArguments arguments;
  CLI::App* render = app.add_subcommand("render", "Render a sequence into a folder");
  render->add_option("--town", arguments.town, "Seed of the town")->required();
  render->add_option("--out", arguments.out, "Folder to write")->required();
  render->add_option("--frames", arguments.frames, "Number of frames")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  render
      ->add_option("--width", arguments.width,
                   "Width of the panorama in pixels; its height is half of it")
      ->capture_default_str()
      ->check(CLI::Range(32, 16384));
  render->add_option("--fps", arguments.fps, "Frames per second")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1000.0));
  render->add_option("--light", arguments.light, "noon, morning, sunset or overcast")
      ->capture_default_str();
  render->add_option("--traffic", arguments.traffic, "Density of moving traffic, 0 to 1")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  render->add_option("--depth-every", arguments.depth_every, "Write the depth of every n-th frame")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  render->add_option("--threads", arguments.threads, "Threads to use; 0: all cores")
      ->capture_default_str()
      ->check(CLI::Range(0, 256));
  CLI11_PARSE(app, argc, argv);
  try {
    orb360::town::Render(arguments);
  } catch (const orb360::UserError& error) {
    std::fprintf(stderr, "town: %s\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "town: internal error: %s\n", error.what());
    return 2;
  }
  return 0;
}
