#include <filesystem>
#include <iomanip>
#include <memory>
#include <sstream>

#include "apps/town/commands.h"
#include "apps/town/import/import_scenery.h"
#include "apps/town/import/torcs_track.h"
#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

struct Arguments {
  std::filesystem::path track;
  std::filesystem::path out;
  double speed = 10;
  double height = 1.6;
  int laps = 1;
};

void WritePath(const Arguments& arguments) {
  std::vector<Eigen::Vector3f> line = FindTorcsCentreline(ReadMeshFile(arguments.track));
  if (line.size() < 3) {
    throw UserError(
        arguments.track.string() +
        ": has no ring of road in pieces named TKMN and a number, as TORCS circuits have");
  }
  std::ostringstream text;
  text << "# time x y z; z up, metres, seconds\n" << std::fixed << std::setprecision(3);
  double travelled = 0;
  for (size_t i = 0; i <= line.size() * static_cast<size_t>(arguments.laps); ++i) {
    const Eigen::Vector3f& here = line[i % line.size()];
    if (i > 0) travelled += (here - line[(i - 1) % line.size()]).cast<double>().norm();
    const Eigen::Vector3d p(here.x(), -here.z(), here.y());
    text << travelled / arguments.speed << ' ' << p.x() << ' ' << p.y() << ' '
         << p.z() + arguments.height << '\n';
  }
  WriteFileAtomically(arguments.out, text.str());
}

}  // namespace

void AddPathCommand(CLI::App* app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app->add_subcommand("path", "Write a path round a circuit of the TORCS simulator");
  command->add_option("--torcs", arguments->track, "The circuit's mesh (.acc)")->required();
  command->add_option("--out", arguments->out, "File to write")->required();
  command->add_option("--speed", arguments->speed, "Metres per second")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 200.0));
  command->add_option("--height", arguments->height, "Metres above the road")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 100.0));
  command->add_option("--laps", arguments->laps, "Times round")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  command->callback([arguments] { WritePath(*arguments); });
}

}  // namespace orb360::town
