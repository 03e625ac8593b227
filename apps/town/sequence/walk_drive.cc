#include "apps/town/sequence/walk_drive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/sequence/stage_exposure.h"
#include "apps/town/world/landscape/landscape.h"
#include "apps/town/world/tunnel/tunnel.h"

namespace orb360::town {
namespace {

/// Parts of a seed, so that the draws of one part do not affect the others.
enum SeedPart : uint64_t { kLight = 70, kCarriage, kSway, kExposure };

/// Returns a route round and round until it takes `seconds`.
RouteWalk WalkRound(const std::vector<Vector2f>& round, double speed, double seconds) {
  std::vector<Vector2f> route;
  while (true) {
    route.insert(route.end(), round.begin(), round.end());
    RouteWalk walk(route, speed);
    if (walk.duration() >= seconds) return walk;
  }
}

}  // namespace

Light WalkDrive::LightOf(const WalkSpec& spec) {
  static constexpr std::array<std::string_view, 4> kNames = {"noon", "morning", "sunset",
                                                             "overcast"};
  Random random = Random(spec.seed).Fork(kLight);
  const std::string_view own = random.Pick(std::span<const std::string_view>(kNames));
  Light light = MakeLight(spec.light ? std::string_view(*spec.light) : own, spec.seed);
  if (spec.world == WalkSpec::World::kTunnel) light.haze = 1e6F;  // it is clear, and no sky is seen
  return light;
}

WalkDrive::World WalkDrive::BuildWorld(const WalkSpec& spec) {
  World world;
  if (spec.world == WalkSpec::World::kTunnel) {
    Tunnel tunnel = BuildTunnel(spec.seed);
    world.scenery = std::move(tunnel.scenery);
    world.round = tunnel.trail.points();
    world.ground = std::move(tunnel.floor);
    world.head_room = tunnel.head_room;
    return world;
  }
  const auto landscape = std::make_shared<Landscape>(BuildLandscape(spec.seed));
  world.scenery = std::move(landscape->scenery);
  world.round = landscape->trail.points();
  world.ground = [landscape](const Vector2f& p) { return landscape->Height(p); };
  world.head_room = kFreeHeight - 0.3;
  return world;
}

WalkDrive::WalkDrive(const WalkSpec& spec, const Recording& recording)
    : Drive(recording),
      spec_(spec),
      light_(LightOf(spec)),
      world_(BuildWorld(spec)),
      carriage_(
          DrawCarriage(spec.mount, world_.head_room, "the way", Random(spec.seed).Fork(kCarriage))),
      stage_(&world_.scenery, light_, spec.seed),
      walk_(WalkRound(world_.round, carriage_.speed,
                      std::max(60.0, recording.frames / recording.fps))) {
  constexpr int kPlaces = 24;
  constexpr double kSpan = 60;  // seconds of the walk, so that its length does not matter
  std::vector<Rigid3> places;
  // In steps of the golden ratio, since even ones could meet each lamp of a row, or none.
  for (int i = 0; i < kPlaces; ++i)
    places.push_back(PoseAt(kSpan * std::fmod((i + 0.5) * std::numbers::phi, 1.0)));
  constexpr double kStops = 0.4;
  const double bias = std::exp2(Random(spec.seed).Fork(kExposure).Uniform(-kStops, 0.5 * kStops));
  stage_.set_exposure(static_cast<float>(bias * ExposureFor(stage_, places)));
}

Rigid3 WalkDrive::PoseAt(double seconds) const {
  const WalkState state = walk_.At(seconds);
  const float ground = world_.ground(state.position.cast<float>());
  return CarriedPose(carriage_, spec_.mount, state, ground, Random(spec_.seed).Fork(kSway),
                     seconds);
}

std::string WalkDrive::Origin() const {
  std::ostringstream text;
  if (spec_.world == WalkSpec::World::kTunnel) {
    text << "tunnel: " << spec_.seed;
  } else {
    text << "landscape: " << spec_.seed << "\nlight: " << light_.name;
  }
  text << "\nmount:  # radians\n  pitch: " << spec_.mount.pitch << "\n  roll: " << spec_.mount.roll
       << "\n  shaking: " << spec_.mount.shaking << "\n";
  return text.str();
}

}  // namespace orb360::town
