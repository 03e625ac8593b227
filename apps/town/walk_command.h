#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/town/import/import_scenery.h"
#include "apps/town/import/walk_path.h"

namespace orb360::town {

/// What the user asks of a walk through a scene.
struct WalkArguments {
  std::optional<uint64_t> seed;  ///< absent unless a walk is asked for
  std::filesystem::path scene;
  ImportOptions import;
  WalkOptions walk;
  std::vector<float> start;  ///< three numbers, or none
};

/// Adds the options of a walk to the command that writes paths.
void AddWalkOptions(CLI::App* command, WalkArguments* arguments);

/// Finds the walk and writes it as lines `time x y z`. Throws UserError.
void WriteWalk(const WalkArguments& arguments, double height, double speed,
               const std::filesystem::path& out);

}  // namespace orb360::town
