#include <iostream>

#include "apps/orb360/commands.h"
#include "slam/pipeline/options.h"

namespace orb360 {

void AddConfigCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand(
      "config", "Print a configuration file with every option, its default and what it means");
  command->callback([chosen] {
    *chosen = [] {
      Options options;
      std::cout << MakeConfigSchema(&options).Document();
      return EXIT_SUCCESS;
    };
  });
}

}  // namespace orb360
