#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "apps/town/commands.h"
#include <orb360/nn/base/check.h>

int main(int argc, char** argv) {
  try {
    CLI::App app("Renders panoramic drives through towns, with exact depth and poses.");
    app.require_subcommand(1);
    orb360::town::AddRenderCommand(&app);
    orb360::town::AddStitchCommand(&app);
    orb360::town::AddDescribeCommand(&app);
    orb360::town::AddPathCommand(&app);
    CLI11_PARSE(app, argc, argv);
  } catch (const orb360::UserError& error) {
    std::fprintf(stderr, "town: %s\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "town: internal error: %s\n", error.what());
    return 2;
  }
  return 0;
}
