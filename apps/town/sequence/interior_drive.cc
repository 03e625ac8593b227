#include "apps/town/sequence/interior_drive.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>
#include <sstream>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/render/renderer.h"
#include "apps/town/sensor/auto_exposure.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Parts of a seed, so that the draws of one part do not affect the others.
enum SeedPart : uint64_t { kLight = 60, kCarriage, kWalk, kSway };

constexpr double kHeadroom = 0.22;  // metres between the camera and a lintel

double LowestDoor(const FloorPlan& plan) {
  double lowest = plan.rooms[0].height;
  for (const Doorway& way : plan.doorways) lowest = std::min<double>(lowest, way.height);
  return lowest;
}

/// Builds the interior, unless its light is unknown.
Interior BuildLit(const InteriorSpec& spec) {
  if (spec.light) MakeLight(*spec.light, spec.seed);  // throws in a moment, not after seconds
  return BuildInterior(spec.seed);
}

/// A slow motion of about unit size at a time in seconds.
double Drift(Random random, double time) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const double rate = 2 * std::numbers::pi * random.Uniform(0.08, 0.45);
    sum += std::sin(rate * time + random.Uniform(0, 2 * std::numbers::pi));
  }
  return 0.5 * sum;
}

}  // namespace

InteriorSpec ParseInterior(std::string_view seed) {
  constexpr size_t kMaximumDigits = 18;  // as of towns
  InteriorSpec spec;
  const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), spec.seed);
  if (error != std::errc() || end != seed.data() + seed.size() || seed.size() > kMaximumDigits) {
    throw UserError("unknown interior '" + std::string(seed) +
                    "': use a seed of at most 18 digits");
  }
  return spec;
}

Light InteriorDrive::LightOf(const InteriorSpec& spec, bool are_lamps_on) {
  static constexpr std::array<std::string_view, 6> kNames = {"noon",   "noon",     "morning",
                                                             "sunset", "overcast", "overcast"};
  Random random = Random(spec.seed).Fork(kLight);
  const std::string_view own = random.Pick(std::span<const std::string_view>(kNames));
  Light light = MakeLight(spec.light ? std::string_view(*spec.light) : own, spec.seed);
  // Dusk, tinted panes, and cameras that lift the dark parts of an image.
  const bool is_night = !spec.light && own == "overcast" && random.Chance(0.35) && are_lamps_on;
  const auto dim = static_cast<float>(is_night ? 0.004 : std::exp(random.Uniform(-2.2, 0)));
  for (Vector3f* radiance : {&light.sun, &light.zenith, &light.horizon, &light.ground})
    *radiance *= dim;
  light.haze = 1e6F;  // rooms are clear
  return light;
}

InteriorDrive::Carriage InteriorDrive::DrawCarriage(const InteriorSpec& spec,
                                                    const FloorPlan& plan) {
  Random random = Random(spec.seed).Fork(kCarriage);
  Carriage carriage;
  const bool is_robot = random.Chance(0.3);
  carriage.height = is_robot ? random.Uniform(0.3, 0.8) : random.Uniform(1.2, 2.2);
  carriage.speed = is_robot ? random.Uniform(0.5, 1) : random.Uniform(0.7, 1.5);
  carriage.sway = (is_robot ? 0.1 : random.Uniform(0.4, 1.2)) * spec.mount.shaking;
  const double highest = LowestDoor(plan) - kHeadroom;
  carriage.height = std::min(carriage.height, highest);
  if (!spec.mount.height) return carriage;
  if (*spec.mount.height > highest) {
    std::ostringstream message;
    message << "the camera is " << *spec.mount.height << " m high, but the doors of interior "
            << spec.seed << " allow " << std::floor(100 * highest) / 100
            << ": lower it with --camera-height";
    throw UserError(message.str());
  }
  carriage.height = *spec.mount.height;
  return carriage;
}

InteriorDrive::InteriorDrive(const InteriorSpec& spec, const Recording& recording)
    : Drive(recording),
      spec_(spec),
      interior_(BuildLit(spec)),
      light_(LightOf(spec, interior_.are_lamps_on)),
      stage_(&interior_.scenery, light_, spec.seed),
      carriage_(DrawCarriage(spec, interior_.plan)),
      walk_(interior_.plan, interior_.taken,
            {carriage_.speed, std::max(60.0, recording.frames / recording.fps)},
            Random(spec.seed).Fork(kWalk)) {
  Expose();
}

void InteriorDrive::Expose() {
  constexpr int kPlaces = 12;
  constexpr double kSpan = 60;  // seconds of the walk, so that its length does not matter
  constexpr double kStops = 0.4;
  constexpr double kBright = 0.92;    // fraction of the pixels that are no brighter than ...
  constexpr double kBrightest = 0.9;  // ... this radiance after exposure
  double sum = 0;
  std::vector<float> luminances;
  for (int i = 0; i < kPlaces; ++i) {
    const double time = kSpan * (i + 0.5) / kPlaces;
    const cv::Mat3f image = RenderRadiance(stage_.With({}), stage_.shader(),
                                           EquirectangularCamera(64, 32), PoseAt(time));
    sum += std::log(MeteredRadiance(image));
    for (const cv::Vec3f& pixel : image) luminances.push_back(pixel[1]);
  }
  const auto bright =
      luminances.begin() + static_cast<int>(kBright * static_cast<double>(luminances.size()));
  std::nth_element(luminances.begin(), bright, luminances.end());
  const double bias =
      std::exp2(Random(spec_.seed).Fork(kLight).Fork(1).Uniform(-kStops, 0.5 * kStops));
  const double gain =
      std::min(AutoExposure().key / std::exp(sum / kPlaces), kBrightest / std::max(1e-6F, *bright));
  stage_.set_exposure(static_cast<float>(bias * gain));
}

Rigid3 InteriorDrive::PoseAt(double seconds) const {
  const Random random = Random(spec_.seed).Fork(kSway);
  const WalkState state = walk_.At(seconds);
  const double sway = carriage_.sway;
  constexpr double kStride = 0.68;  // metres a step
  const double phase = 2 * std::numbers::pi * state.distance / kStride;
  const double yaw =
      state.heading + sway * (0.12 * Drift(random.Fork(1), seconds) + 0.02 * std::sin(0.5 * phase));
  const double nose_up = sway * (0.02 * Drift(random.Fork(2), seconds) + 0.008 * std::sin(phase));
  const double left_up =
      sway * (0.02 * Drift(random.Fork(3), seconds) + 0.014 * std::sin(0.5 * phase));
  const double aside = 0.018 * sway * std::sin(0.5 * phase);  // metres
  const double heave = sway * (0.014 * std::cos(phase) + 0.008 * Drift(random.Fork(4), seconds));
  // A level camera that looks along world +x: camera (-X, +Y, +Z) is world (+x, -y, +z).
  const Eigen::Quaterniond level(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond body =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(-nose_up - spec_.mount.pitch, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(left_up + spec_.mount.roll, Eigen::Vector3d::UnitX());
  Rigid3 pose;
  pose.rotation = (body * level).normalized();
  pose.translation << state.position, carriage_.height + heave;
  pose.translation.head<2>() +=
      aside * Eigen::Vector2d(-std::sin(state.heading), std::cos(state.heading));
  return pose;
}

std::string InteriorDrive::Origin() const {
  std::ostringstream text;
  text << "interior: " << spec_.seed << "\nlight: " << light_.name
       << "\nmount:  # radians\n  pitch: " << spec_.mount.pitch << "\n  roll: " << spec_.mount.roll
       << "\n  shaking: " << spec_.mount.shaking << "\n";
  return text.str();
}

}  // namespace orb360::town
