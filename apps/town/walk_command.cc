#include "apps/town/walk_command.h"

#include <algorithm>
#include <map>
#include <string>

#include "apps/town/import/camera_path.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Returns the part of the scene that a walk of `length` metres from the starts stays in.
Eigen::AlignedBox3f BoxToWalk(const Scenery& scenery, const std::vector<Vector3f>& starts,
                              double length) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& p : scenery.fixed.positions) box.extend(p);
  constexpr float kBeyond = 0.5F;  // metres; surfaces on the border are inside
  box.min().array() -= kBeyond;
  box.max().array() += kBeyond;
  if (starts.empty()) return box;
  Eigen::AlignedBox3f near;
  for (const Vector3f& start : starts) near.extend(start);
  near.min().head<2>().array() -= static_cast<float>(length);
  near.max().head<2>().array() += static_cast<float>(length);
  near.min().z() = box.min().z();
  near.max().z() = box.max().z();
  return box.intersection(near);
}

/// Returns the walk through a scene, z up, in metres.
Walk FindWalk(const WalkArguments& arguments, double height) {
  const SourceScene source = ReadMeshFile(arguments.scene);
  // Textures matter because people do not walk through leaves, but through holes.
  std::vector<std::string> missing;
  const Scenery scenery =
      MakeScenery(source, arguments.scene.parent_path(), arguments.import, &missing);
  WalkOptions options = arguments.walk;
  options.seed = *arguments.seed;
  options.size.camera_height = height;
  for (const SourceMaterial& material : source.materials)
    options.is_floor.push_back(!material.is_liquid);
  if (!arguments.start.empty()) {
    options.starts = {Vector3f(arguments.start[0], arguments.start[1], arguments.start[2])};
  } else {
    for (const Vector3f& start : source.starts)
      options.starts.push_back(ToWorld(start, arguments.import));
  }
  const Eigen::AlignedBox3f box = BoxToWalk(scenery, options.starts, options.length);
  try {
    if (box.isEmpty()) throw UserError("the start is outside the scene (see --start and --scale)");
    return WalkThrough(RayScene(scenery), box, options);
  } catch (const UserError& error) {
    throw UserError(arguments.scene.string() + ": " + error.what());
  }
}

}  // namespace

void AddWalkOptions(CLI::App* command, WalkArguments* arguments) {
  CLI::Option* walk = command->add_option(
      "--walk", arguments->seed, "Walk through the --scene to places drawn from this seed");
  CLI::Option* scene =
      command->add_option("--scene", arguments->scene, "A file of meshes, as render takes it");
  walk->needs(scene);
  scene->needs(walk);
  command->add_option("--length", arguments->walk.length, "Metres to walk")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 100000.0))
      ->needs(walk);
  command
      ->add_option("--start", arguments->start,
                   "Where to begin: x,y,z on the floor, z up, in metres [players' places of a "
                   "map; anywhere in the largest area]")
      ->delimiter(',')
      ->expected(3)
      ->needs(walk);
  command->add_option("--step", arguments->walk.size.step, "The highest step, metres")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0))
      ->needs(walk);
  command->add_option("--scale", arguments->import.scale, "Metres that a unit of the scene is")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e6))
      ->needs(walk);
  command->add_option("--up", arguments->import.up, "Axis of the scene's file that points up")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, UpAxis>{{"y", UpAxis::kY}, {"z", UpAxis::kZ}}))
      ->default_str("y")
      ->needs(walk);
  command
      ->add_option("--textures", arguments->import.texture_folders,
                   "Folders with textures besides that of the scene")
      ->needs(walk);
}

void WriteWalk(const WalkArguments& arguments, double height, double speed,
               const std::filesystem::path& out) {
  const Walk walk = FindWalk(arguments, height);
  std::vector<double> times;
  for (size_t i = 0; i < walk.positions.size(); ++i)
    times.push_back(static_cast<double>(i) * walk.spacing / speed);
  WriteCameraPath(times, walk.positions, out);
}

}  // namespace orb360::town
