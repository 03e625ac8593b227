#include "slam/io/dataset.h"

#include <cmath>
#include <string>

#include <yaml-cpp/yaml.h>

#include "slam/check.h"

namespace orb360 {
namespace {

constexpr const char* kFileName = "sequence.yaml";

/// A positive number under `key`; nullopt where the key is absent.
std::optional<double> PositiveNumber(const YAML::Node& root, const char* key,
                                     const std::string& file) {
  const YAML::Node node = root[key];
  if (!node) return std::nullopt;
  double value = 0.0;
  if (!YAML::convert<double>::decode(node, value) || !std::isfinite(value) || value <= 0.0) {
    throw UserError(file + ":" + std::to_string(node.Mark().line + 1) + ": " + key +
                    " must be a positive number");
  }
  return value;
}

}  // namespace

bool IsDataset(const std::filesystem::path& path) {
  return std::filesystem::is_regular_file(path / kFileName);
}

Dataset OpenDataset(const std::filesystem::path& folder) {
  const std::string file = (folder / kFileName).string();
  YAML::Node root;
  try {
    root = YAML::LoadFile(file);
  } catch (const YAML::ParserException& error) {
    throw UserError(file + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  } catch (const YAML::BadFile&) {
    throw UserError(file + ": cannot be opened");
  }
  if (!root.IsMap()) throw UserError(file + ": is not a list of `key: value` lines");
  const YAML::Node model = root["camera_model"];
  if (!model || !model.IsScalar() || model.Scalar() != "equirectangular") {
    throw UserError(file + ": camera_model must be `equirectangular`");
  }
  const std::optional<double> frame_rate = PositiveNumber(root, "frame_rate", file);
  if (!frame_rate) throw UserError(file + ": frame_rate (frames a second) is missing");
  return {folder, *frame_rate, PositiveNumber(root, "camera_height", file)};
}

}  // namespace orb360
