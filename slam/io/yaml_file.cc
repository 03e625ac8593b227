#include "slam/io/yaml_file.h"

#include <yaml-cpp/yaml.h>

#include <orb360/nn/base/check.h>

namespace orb360 {

YAML::Node LoadYamlMap(const std::filesystem::path& file) {
  YAML::Node root;
  try {
    // Opening a folder succeeds, but reading it fails with an unclear message.
    if (std::filesystem::is_directory(file)) throw YAML::BadFile(file.string());
    root = YAML::LoadFile(file.string());
  } catch (const YAML::ParserException& error) {
    throw UserError(file.string() + ":" + std::to_string(error.mark.line + 1) +
                    ": not valid YAML: " + error.msg);
  } catch (const YAML::BadFile&) {
    throw UserError(file.string() + ": cannot be opened as a YAML file");
  }
  if (root.IsNull()) return YAML::Node(YAML::NodeType::Map);
  if (!root.IsMap()) throw UserError(WhereIs(file, root) + "must consist of `key: value` lines");
  return root;
}

std::string WhereIs(const std::filesystem::path& file, const YAML::Node& node) {
  return file.string() + ":" + std::to_string(node.Mark().line + 1) + ": ";
}

}  // namespace orb360
