#include <iostream>

#include "apps/orb360/commands.h"
#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/io/config.h>
#include <orb360/slam/pipeline/options.h>

namespace orb360 {

void AddConfigCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand(
      "config", "Print a configuration file with every option, its default and what it means");
  command->callback([chosen] {
    *chosen = [] {
      Options options;
      OptionSchema schema;
      RegisterOptions(&schema, &options);
      std::cout << DocumentConfig(schema);
      return EXIT_SUCCESS;
    };
  });
}

}  // namespace orb360
