#include <filesystem>
#include <iomanip>
#include <memory>
#include <sstream>

#include "apps/town/commands.h"
#include "apps/town/import/import_scenery.h"
#include "apps/town/import/torcs_track.h"
#include "slam/check.h"
#include "slam/io/atomic_file.h"

namespace orb360::town {
namespace {

struct Arguments {
  std::filesystem::path track;
  std::filesystem::path out;
  double speed = 10;
  double height = 1.6;
};

void WritePath(const Arguments& arguments) {
  std::vector<Eigen::Vector3f> line = FindTorcsCentreline(ReadMeshFile(arguments.track));
  if (line.size() < 3) {
    throw UserError(
        arguments.track.string() +
        ": has no ring of road in pieces named TKMN and a number, as TORCS circuits have");
  }
  line.push_back(line.front());
  std::ostringstream text;
  text << "# time x y z; z up, metres, seconds\n" << std::fixed << std::setprecision(3);
  double travelled = 0;
  for (size_t i = 0; i < line.size(); ++i) {
    if (i > 0) travelled += (line[i] - line[i - 1]).cast<double>().norm();
    const Eigen::Vector3d p(line[i].x(), -line[i].z(), line[i].y());
    text << travelled / arguments.speed << ' ' << p.x() << ' ' << p.y() << ' '
         << p.z() + arguments.height << '\n';
  }
  WriteFileAtomically(arguments.out, text.str());
}

}  // namespace

void AddPathCommand(CLI::App* app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app->add_subcommand("path", "Write a path once round a circuit of the TORCS simulator");
  command->add_option("--torcs", arguments->track, "The circuit's mesh (.acc)")->required();
  command->add_option("--out", arguments->out, "File to write")->required();
  command->add_option("--speed", arguments->speed, "Metres per second")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 200.0));
  command->add_option("--height", arguments->height, "Metres above the road")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 100.0));
  command->callback([arguments] { WritePath(*arguments); });
}

}  // namespace orb360::town
