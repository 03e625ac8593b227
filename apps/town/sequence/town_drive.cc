#include "apps/town/sequence/town_drive.h"

#include <sstream>

#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

/// Parts of a seed, so that the draws of one part do not affect the others.
enum SeedPart : uint64_t { kCameraHeight = 50, kLap, kTraffic = 53, kShaking };

uint64_t SeedOf(const TownSpec& spec, SeedPart part) { return Random(spec.seed).Fork(part).Next(); }

CameraMotionOptions MotionOf(const TownSpec& spec) {
  const double height = Random(SeedOf(spec, kCameraHeight)).Uniform(1.8, 2.2);
  return {.seed = SeedOf(spec, kShaking),
          .height = spec.mount.height.value_or(height),
          .pitch = spec.mount.pitch,
          .roll = spec.mount.roll,
          .shaking = spec.mount.shaking};
}

}  // namespace

LapOptions LapOf(const TownSpec& spec) { return {.seed = SeedOf(spec, kLap)}; }

TownDrive::TownDrive(const TownSpec& spec, const Recording& recording)
    : TownDrive(spec, MakeLight(spec.light, spec.seed), recording) {}

TownDrive::TownDrive(const TownSpec& spec, const Light& light, const Recording& recording)
    : Drive(recording),
      spec_(spec),
      town_(BuildTown(spec.seed, spec.plan)),
      stage_(&town_.scenery, light, spec.seed),
      lap_(town_.plan, town_.plan.tour, LapOf(spec)),
      traffic_(town_, lap_,
               {.seed = SeedOf(spec, kTraffic),
                .density = spec.traffic,
                .until = recording.frames / recording.fps}),
      motion_(MotionOf(spec)) {}

Rigid3 TownDrive::PoseAt(double seconds) const {
  return CameraPose(traffic_.own(), motion_, seconds);
}

std::vector<Instance> TownDrive::MovingAt(double seconds) const { return traffic_.At(seconds); }

std::string TownDrive::Origin() const {
  std::ostringstream text;
  text << "town: " << spec_.name << "\nseed: " << spec_.seed << "\nlight: " << spec_.light
       << "\ntraffic: " << spec_.traffic << "\nmount:  # radians\n  pitch: " << motion_.pitch
       << "\n  roll: " << motion_.roll << "\n  shaking: " << motion_.shaking << "\n";
  return text.str();
}

}  // namespace orb360::town
