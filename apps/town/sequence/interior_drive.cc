#include "apps/town/sequence/interior_drive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <sstream>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/sequence/stage_exposure.h"

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

}  // namespace

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

InteriorDrive::InteriorDrive(const InteriorSpec& spec, const Recording& recording)
    : Drive(recording),
      spec_(spec),
      interior_(BuildLit(spec)),
      light_(LightOf(spec, interior_.are_lamps_on)),
      stage_(&interior_.scenery, light_, spec.seed),
      carriage_(DrawCarriage(spec.mount, LowestDoor(interior_.plan) - kHeadroom,
                             "the lowest door of the interior", Random(spec.seed).Fork(kCarriage))),
      walk_(interior_.plan, interior_.taken,
            {carriage_.speed, std::max(60.0, recording.frames / recording.fps)},
            Random(spec.seed).Fork(kWalk)) {
  Expose();
}

void InteriorDrive::Expose() {
  constexpr int kPlaces = 12;
  constexpr double kSpan = 60;  // seconds of the walk, so that its length does not matter
  std::vector<Rigid3> places;
  for (int i = 0; i < kPlaces; ++i) places.push_back(PoseAt(kSpan * (i + 0.5) / kPlaces));
  constexpr double kStops = 0.4;
  const double bias =
      std::exp2(Random(spec_.seed).Fork(kLight).Fork(1).Uniform(-kStops, 0.5 * kStops));
  stage_.set_exposure(static_cast<float>(bias * ExposureFor(stage_, places)));
}

Rigid3 InteriorDrive::PoseAt(double seconds) const {
  return CarriedPose(carriage_, spec_.mount, walk_.At(seconds), 0, Random(spec_.seed).Fork(kSway),
                     seconds);
}

std::string InteriorDrive::Origin() const {
  std::ostringstream text;
  text << "interior: " << spec_.seed << "\nlight: " << light_.name
       << "\nmount:  # radians\n  pitch: " << spec_.mount.pitch << "\n  roll: " << spec_.mount.roll
       << "\n  shaking: " << spec_.mount.shaking << "\n";
  return text.str();
}

}  // namespace orb360::town
