#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "apps/town/commands.h"
#include "apps/town/sequence/named_town.h"
#include "apps/town/sequence/statistics.h"
#include "apps/town/sequence/town_drive.h"

namespace orb360::town {
namespace {

constexpr int kSought = 2000;  // corners, as orb360 does by default

struct Arguments {
  std::vector<std::string> towns;
  int every = 50;
};

void Describe(const Arguments& arguments) {
  std::vector<TownSpec> specs;  // all of them before the first is built
  for (const std::string& name : arguments.towns) specs.push_back(FindTown(name));
  std::vector<DriveStatistics> statistics;
  for (const TownSpec& spec : specs) {
    const TownDrive drive(spec, {EquirectangularCamera(1024, 512), 20, spec.frames});
    statistics.push_back(MeasureDrive(drive, arguments.every, kSought));
  }
  std::fputs(StatisticsTable(arguments.towns, statistics).c_str(), stdout);
}

}  // namespace

void AddDescribeCommand(CLI::App* app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app->add_subcommand(
      "describe", "Print speeds, turns, revisits, ranges and corners of drives as a table");
  command->add_option("TOWN", arguments->towns, "Town1 ... Town5, Loop, or a seed")->required();
  command
      ->add_option("--every", arguments->every,
                   "Look for ranges and corners in every n-th frame, rendered at 1024x512")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command->callback([arguments] { Describe(*arguments); });
}

}  // namespace orb360::town
