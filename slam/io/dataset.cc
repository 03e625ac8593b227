#include "slam/io/dataset.h"

#include <cmath>
#include <string>

#include <yaml-cpp/yaml.h>

#include "slam/io/yaml_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr const char* kFileName = "sequence.yaml";

/// Returns the positive number under `key`, or nullopt if the key is absent.
std::optional<double> PositiveNumber(const YAML::Node& root, const char* key,
                                     const std::filesystem::path& file) {
  const YAML::Node node = root[key];
  if (!node) return std::nullopt;
  double value = 0.0;
  if (!YAML::convert<double>::decode(node, value) || !std::isfinite(value) || value <= 0.0) {
    throw UserError(WhereIs(file, node) + key + " must be a positive number");
  }
  return value;
}

}  // namespace

bool IsDataset(const std::filesystem::path& path) {
  return std::filesystem::is_regular_file(path / kFileName);
}

Dataset OpenDataset(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kFileName;
  const YAML::Node root = LoadYamlMap(file);
  const YAML::Node camera = root["camera"];
  const YAML::Node model = camera && camera.IsMap() ? camera["model"] : YAML::Node();
  if (!model || !model.IsScalar() || model.Scalar() != "equirectangular") {
    throw UserError(file.string() + ": camera.model must be `equirectangular`");
  }
  const std::optional<double> frame_rate = PositiveNumber(root, "fps", file);
  if (!frame_rate) throw UserError(file.string() + ": fps (frames a second) is missing");
  return {folder, *frame_rate, PositiveNumber(root, "camera_height", file)};
}

}  // namespace orb360
