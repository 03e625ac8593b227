#include "slam/io/lenses/lens_calibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <yaml-cpp/yaml.h>

#include "nn/base/number_text.h"
#include "slam/io/full_sphere.h"
#include "slam/io/lenses/lens_presets.h"
#include "slam/io/yaml_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kRadian = std::numbers::pi / 180.0;
constexpr const char* kSideBySide = "side_by_side";
constexpr const char* kTwoTracks = "two_tracks";

/// Reads values of one map of a calibration file.
class MapReader {
 public:
  MapReader(const std::filesystem::path& file, const YAML::Node& map, std::string what)
      : file_(file), map_(map), what_(std::move(what)) {
    if (!map.IsMap()) throw UserError(WhereIs(file, map) + what_ + " must be `key: value` lines");
  }

  /// Throws UserError for a key that is not among those.
  void AllowOnly(const std::vector<std::string>& keys) const {
    for (const auto& entry : map_) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
      if (std::ranges::find(keys, key) == keys.end()) {
        throw UserError(WhereIs(file_, entry.first) + "unknown key `" + key + "` of " + what_);
      }
    }
  }

  bool Has(const char* key) const { return static_cast<bool>(map_[key]); }

  YAML::Node Required(const char* key) const {
    if (Has(key)) return map_[key];
    throw UserError(WhereIs(file_, map_) + key + " of " + what_ + " is missing");
  }

  /// Returns `count` finite numbers between `low` and `high`.
  std::vector<double> Numbers(const char* key, size_t count, double low, double high) const {
    const YAML::Node node = Required(key);
    std::vector<double> numbers;
    if (count == 1) {
      Append(node, &numbers);
    } else if (node.IsSequence() && node.size() == count) {
      for (const YAML::Node& each : node) Append(each, &numbers);
    }
    const bool is_good = numbers.size() == count && std::ranges::all_of(numbers, [&](double x) {
                           return x >= low && x <= high;
                         });
    if (is_good) return numbers;
    throw UserError(WhereIs(file_, node) + key + " of " + what_ + " must be " +
                    (count == 1 ? "a number" : std::to_string(count) + " numbers") + " from " +
                    ToText(low) + " to " + ToText(high));
  }

  double Number(const char* key, double low, double high) const {
    return Numbers(key, 1, low, high)[0];
  }

 private:
  static void Append(const YAML::Node& node, std::vector<double>* numbers) {
    double value = 0.0;
    if (YAML::convert<double>::decode(node, value)) numbers->push_back(value);
  }

  const std::filesystem::path& file_;
  YAML::Node map_;
  std::string what_;
};

FisheyeLens ReadLens(const std::filesystem::path& file, const YAML::Node& node, int number) {
  constexpr double kMaxSide = 16000;  // pixels
  const MapReader reader(file, node, "lens " + std::to_string(number));
  reader.AllowOnly(
      {"size", "center", "focal", "polynomial", "field_of_view", "rotation", "position"});
  FisheyeLens lens;
  const std::vector<double> size = reader.Numbers("size", 2, 16, kMaxSide);
  lens.size = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  const std::vector<double> center = reader.Numbers("center", 2, 0, kMaxSide);
  lens.center = {center[0], center[1]};
  lens.focal = reader.Number("focal", 1, kMaxSide);
  if (reader.Has("polynomial")) {
    std::ranges::copy(reader.Numbers("polynomial", 4, -10, 10), lens.polynomial.begin());
  }
  lens.field_of_view = reader.Number("field_of_view", 90, 300) * kRadian;
  const std::vector<double> rotation = reader.Numbers("rotation", 4, -1.001, 1.001);
  lens.camera_from_lens = {rotation[3], rotation[0], rotation[1], rotation[2]};
  if (std::abs(lens.camera_from_lens.norm() - 1.0) > 1e-3) {
    throw UserError(WhereIs(file, node["rotation"]) + "rotation of lens " + std::to_string(number) +
                    " must be a unit quaternion (x, y, z, w)");
  }
  lens.camera_from_lens.normalize();
  if (reader.Has("position")) {
    const std::vector<double> position = reader.Numbers("position", 3, -10, 10);
    lens.position = {position[0], position[1], position[2]};
  }
  if (!IsMonotonic(lens)) {
    throw UserError(WhereIs(file, node) + "polynomial of lens " + std::to_string(number) +
                    " makes the radius shrink inside of the field of view");
  }
  return lens;
}

}  // namespace

LensCalibration ReadLensCalibration(const std::filesystem::path& file) {
  const YAML::Node root = LoadYamlMap(file);
  const MapReader reader(file, root, "the calibration");
  reader.AllowOnly({"model", "layout", "distance", "lenses"});
  const YAML::Node model = reader.Required("model");
  if (!model.IsScalar() || model.Scalar() != "dual_fisheye") {
    throw UserError(WhereIs(file, model) + "model must be `dual_fisheye`");
  }
  LensCalibration calibration;
  const YAML::Node layout = reader.Required("layout");
  const std::string name = layout.IsScalar() ? layout.Scalar() : std::string();
  if (name != kSideBySide && name != kTwoTracks) {
    throw UserError(WhereIs(file, layout) + "layout must be `side_by_side` or `two_tracks`");
  }
  calibration.is_side_by_side = name == kSideBySide;
  if (reader.Has("distance")) calibration.distance = reader.Number("distance", 0, 1e6);
  const YAML::Node lenses = reader.Required("lenses");
  if (!lenses.IsSequence() || lenses.size() != 2) {
    throw UserError(WhereIs(file, lenses) + "lenses must be a list of two");
  }
  for (int i = 0; i < 2; ++i) calibration.lenses[i] = ReadLens(file, lenses[i], i + 1);
  return calibration;
}

std::string ToYaml(const LensCalibration& calibration) {
  const auto list = [](std::initializer_list<double> numbers) {
    std::string text;
    for (const double number : numbers) text += (text.empty() ? "[" : ", ") + ToText(number);
    return text + "]";
  };
  std::string yaml = "# docs/formats/lens_calibration.md of orb360 describes this file.\n";
  yaml += "model: dual_fisheye\n";
  yaml += std::string("layout: ") + (calibration.is_side_by_side ? kSideBySide : kTwoTracks) + "\n";
  yaml += "distance: " + ToText(calibration.distance) + "\nlenses:\n";
  for (const FisheyeLens& lens : calibration.lenses) {
    const Eigen::Quaterniond& q = lens.camera_from_lens;
    const auto& k = lens.polynomial;
    yaml += "  - size: " + list({1.0 * lens.size.width, 1.0 * lens.size.height}) + "\n";
    yaml += "    center: " + list({lens.center.x(), lens.center.y()}) + "\n";
    yaml += "    focal: " + ToText(lens.focal) + "\n";
    yaml += "    polynomial: " + list({k[0], k[1], k[2], k[3]}) + "\n";
    yaml += "    field_of_view: " + ToText(lens.field_of_view / kRadian) + "\n";
    yaml += "    rotation: " + list({q.x(), q.y(), q.z(), q.w()}) + "\n";
    yaml +=
        "    position: " + list({lens.position.x(), lens.position.y(), lens.position.z()}) + "\n";
  }
  return yaml;
}

LensCalibration FindLensCalibration(const std::string& name_or_file) {
  if (const std::optional<LensCalibration> preset = LensPreset(name_or_file)) return *preset;
  if (!std::filesystem::exists(name_or_file)) {
    std::string names;
    for (const std::string& name : LensPresetNames()) names += (names.empty() ? "" : ", ") + name;
    throw UserError("--lens: `" + name_or_file + "` is neither a calibration file nor one of " +
                    names);
  }
  return ReadLensCalibration(name_or_file);
}

LensCalibration ScaledTo(const LensCalibration& calibration, const std::vector<cv::Size>& sizes,
                         const std::string& name) {
  LensCalibration scaled = calibration;
  for (size_t i = 0; i < 2; ++i) {
    const std::optional<FisheyeLens> lens = ScaledTo(calibration.lenses[i], sizes.at(i));
    if (!lens) {
      throw UserError(name + ": the image of lens " + std::to_string(i + 1) + " is " +
                      ToString(sizes[i]) + ", and its calibration is for " +
                      ToString(calibration.lenses[i].size) +
                      " or the same proportions; give the calibration of this camera with --lens");
    }
    scaled.lenses[i] = *lens;
  }
  return scaled;
}

cv::Size SphereSize(const LensCalibration& calibration) {
  // Pixels per radian at the rim, where both lenses meet, are about those at the axis.
  constexpr int kStep = 64;  // pixels
  const double focal = std::max(calibration.lenses[0].focal, calibration.lenses[1].focal);
  const int width = kStep * std::max(1, static_cast<int>(2.0 * std::numbers::pi * focal / kStep));
  return {width, width / 2};
}

StitchSampler DualFisheyeSampler(const LensCalibration& calibration) {
  return [calibration](const Eigen::Vector3d& bearing, std::vector<StitchSample>* samples) {
    // The difference of both angles changes by two degrees for each degree between the lenses.
    constexpr double kBlend = 4.0 * kRadian;
    // The optical frame of the camera from the camera frame (-X forward, +Y right, +Z up).
    const Eigen::Vector3d ray(bearing.y(), -bearing.z(), -bearing.x());
    std::array<double, 2> angle{};
    for (int i = 0; i < 2; ++i) {
      const FisheyeLens& lens = calibration.lenses[i];
      const Eigen::Vector3d from_lens =
          calibration.distance > 0.0 ? Eigen::Vector3d(calibration.distance * ray - lens.position)
                                     : ray;
      const Eigen::Vector3d in_lens = lens.camera_from_lens.conjugate() * from_lens;
      angle[i] = std::atan2(in_lens.head<2>().norm(), in_lens.z());
      if (angle[i] > 0.5 * lens.field_of_view) continue;
      const Eigen::Vector2d pixel = Project(lens, in_lens);
      const bool is_inside = pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= lens.size.width &&
                             pixel.y() <= lens.size.height;
      if (is_inside) samples->push_back({i, pixel.x(), pixel.y(), 1.0});
    }
    if (samples->size() < 2) return;
    const double first = std::clamp(0.5 + (angle[1] - angle[0]) / kBlend, 0.0, 1.0);
    (*samples)[0].weight = first;
    (*samples)[1].weight = 1.0 - first;
  };
}

}  // namespace orb360
