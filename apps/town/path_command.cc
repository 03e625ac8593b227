#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "apps/town/commands.h"
#include "apps/town/import/camera_path.h"
#include "apps/town/import/import_scenery.h"
#include "apps/town/import/road_line.h"
#include "apps/town/import/supertuxkart_driveline.h"
#include "apps/town/import/torcs_track.h"
#include "apps/town/walk_command.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

struct Arguments {
  std::filesystem::path torcs;
  std::filesystem::path kart;
  std::filesystem::path out;
  std::optional<double> speed;
  double height = 1.6;
  std::optional<int> laps;
  WalkArguments walk;
};

/// Turns the axes of a file with y upward to z upward.
Eigen::Vector3d ZUp(const Eigen::Vector3f& p) { return ToWorld(p, {}).cast<double>(); }

/// Returns the camera's places once round a circuit of TORCS.
std::vector<Eigen::Vector3d> FollowTorcs(const std::filesystem::path& mesh, double height) {
  const std::vector<Eigen::Vector3f> line = FindTorcsCentreline(ReadMeshFile(mesh));
  if (line.size() < 3) {
    throw UserError(
        mesh.string() +
        ": has no ring of road in pieces named TKMN and a number, as TORCS circuits have");
  }
  std::vector<Eigen::Vector3d> places;
  for (const Eigen::Vector3f& p : line)
    places.emplace_back(ZUp(p) + height * Eigen::Vector3d::UnitZ());
  return places;
}

/// Returns the camera's places once round a track of SuperTuxKart.
std::vector<Eigen::Vector3d> FollowKart(const std::filesystem::path& scene_file, double height) {
  std::vector<RoadWidth> sections;
  for (const RoadSection& section : ReadSuperTuxKartDriveline(scene_file))
    sections.push_back({ZUp(section.left), ZUp(section.right)});
  std::vector<std::string> missing;
  const Scenery scenery =
      MakeScenery(ReadMeshFile(scene_file), scene_file.parent_path(), {}, &missing);
  return FollowRoad(RayScene(scenery), sections, height);
}

void WriteLaps(const Arguments& arguments) {
  const std::vector<Eigen::Vector3d> line = arguments.kart.empty()
                                                ? FollowTorcs(arguments.torcs, arguments.height)
                                                : FollowKart(arguments.kart, arguments.height);
  const double speed = arguments.speed.value_or(10);
  std::vector<double> times;
  std::vector<Eigen::Vector3d> places;
  double travelled = 0;
  const auto laps = static_cast<size_t>(arguments.laps.value_or(1));
  for (size_t i = 0; i <= line.size() * laps; ++i) {
    places.push_back(line[i % line.size()]);
    if (i > 0) travelled += (places[i] - places[i - 1]).norm();
    times.push_back(travelled / speed);
  }
  WriteCameraPath(times, places, arguments.out);
}

void WritePath(const Arguments& arguments) {
  const int ways =
      !arguments.torcs.empty() + !arguments.kart.empty() + arguments.walk.seed.has_value();
  if (ways != 1)
    throw UserError("path takes one of --torcs, --kart and --walk (see town path --help)");
  if (arguments.walk.seed) {
    if (arguments.laps) throw UserError("--laps is for --torcs and --kart: a walk has a --length");
    WriteWalk(arguments.walk, arguments.height, arguments.speed.value_or(1.2), arguments.out);
  } else {
    WriteLaps(arguments);
  }
}

}  // namespace

void AddPathCommand(CLI::App* app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app->add_subcommand("path", "Write a path: round a circuit, or on foot through a scene");
  command->add_option("--torcs", arguments->torcs, "A circuit's mesh (.acc)");
  command->add_option("--kart", arguments->kart, "The scene.xml of a track of SuperTuxKart");
  AddWalkOptions(command, &arguments->walk);
  command->add_option("--out", arguments->out, "File to write")->required();
  command->add_option("--speed", arguments->speed, "Metres per second [10; on foot 1.2]")
      ->check(CLI::Range(0.1, 200.0));
  command->add_option("--height", arguments->height, "Metres above the road or the floor")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 100.0));
  command->add_option("--laps", arguments->laps, "Times round [1]")->check(CLI::Range(1, 100));
  command->callback([arguments] { WritePath(*arguments); });
}

}  // namespace orb360::town
