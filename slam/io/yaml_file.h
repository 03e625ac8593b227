#pragma once

#include <filesystem>
#include <string>

#include <yaml-cpp/node/node.h>

namespace orb360 {

/// Returns the map at the top of a YAML file, empty for an empty file. Throws UserError with file
/// and line for a file that cannot be opened, is not YAML, or contains something else at the top.
YAML::Node LoadYamlMap(const std::filesystem::path& file);

/// Returns "file:line: " for messages about `node`; lines count from 1.
std::string WhereIs(const std::filesystem::path& file, const YAML::Node& node);

}  // namespace orb360
