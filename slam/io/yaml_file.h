#pragma once

#include <filesystem>
#include <string>

#include <yaml-cpp/node/node.h>

namespace orb360 {

/// The map at the top of a YAML file, empty for an empty file. Throws UserError, naming file and
/// line, for a file that cannot be opened, is not YAML or holds something else.
YAML::Node LoadYamlMap(const std::filesystem::path& file);

/// "file:line: ", for messages about `node`; lines count from 1.
std::string WhereIs(const std::filesystem::path& file, const YAML::Node& node);

}  // namespace orb360
