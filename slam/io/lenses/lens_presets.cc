#include "slam/io/lenses/lens_presets.h"

#include <algorithm>
#include <numbers>

namespace orb360 {
namespace {

/// How the image of a lens is turned in its file, clockwise as it is looked at.
enum class Turn { kNone, kLeft, kRight };

/// Two equal lenses that look forward and backward.
struct Preset {
  const char* name;
  bool is_side_by_side;
  cv::Size size;           // of the image of one lens, pixels
  Eigen::Vector2d center;  // pixels
  double radius;           // of the image circle, pixels
  double field_of_view;    // degrees, of the circle
  Turn first;              // how the first image is turned
  Turn second;
};

/// Fusion: parameters of a hobbyist for the mode 3K (repository trek-view/fusion2sphere,
/// parameter-examples/video-3k-mode.txt). Osmo 360: the layout and field of view that its users
/// have found (repository xaionaro-go/djictl, issue 3). The others are ideal: the circle fills the
/// image in the middle of its half, with the field of view that the camera is said to have.
const std::vector<Preset>& Presets() {
  static const std::vector<Preset> presets = {
      {"dji-osmo360", false, {3840, 3840}, {1920, 1920}, 1920, 190, Turn::kNone, Turn::kNone},
      {"gopro-fusion", false, {1568, 1504}, {779, 742}, 765, 190, Turn::kNone, Turn::kNone},
      {"insta360", false, {2880, 2880}, {1440, 1440}, 1440, 200, Turn::kRight, Turn::kLeft},
      {"insta360-side-by-side", true, {1920, 1920}, {960, 960}, 960, 200, Turn::kNone, Turn::kNone},
      {"ricoh-theta", true, {960, 960}, {480, 480}, 450, 190, Turn::kLeft, Turn::kRight},
      {"samsung-gear360", true, {1920, 1920}, {960, 960}, 960, 195, Turn::kNone, Turn::kNone}};
  return presets;
}

/// Rotation about the axis of a lens whose image is turned.
Eigen::Quaterniond AboutAxis(Turn turn) {
  const double quarter = std::numbers::pi / 2;
  const double angle = turn == Turn::kNone ? 0.0 : turn == Turn::kLeft ? quarter : -quarter;
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

}  // namespace

std::optional<LensCalibration> LensPreset(const std::string& name) {
  const auto preset = std::ranges::find(Presets(), name, &Preset::name);
  if (preset == Presets().end()) return std::nullopt;
  FisheyeLens lens;
  lens.size = preset->size;
  lens.center = preset->center;
  lens.field_of_view = preset->field_of_view * std::numbers::pi / 180.0;
  lens.focal = preset->radius / (0.5 * lens.field_of_view);
  LensCalibration calibration;
  calibration.is_side_by_side = preset->is_side_by_side;
  calibration.lenses = {lens, lens};
  const Eigen::Quaterniond backward(0.0, 0.0, 1.0, 0.0);  // half a turn about the vertical
  calibration.lenses[0].camera_from_lens = AboutAxis(preset->first);
  calibration.lenses[1].camera_from_lens = backward * AboutAxis(preset->second);
  return calibration;
}

std::vector<std::string> LensPresetNames() {
  std::vector<std::string> names;
  for (const Preset& preset : Presets()) names.emplace_back(preset.name);
  return names;
}

}  // namespace orb360
