#include "apps/town/sequence/drive.h"

#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/render/openness.h"

namespace orb360::town {
namespace {

/// Parts of a seed, so that what one part draws leaves the others as they are.
enum SeedPart : uint64_t { kCameraHeight = 50, kLap, kOncomingLap, kTraffic, kShaking, kStart };

uint64_t SeedOf(const TownSpec& spec, SeedPart part) { return Random(spec.seed).Fork(part).Next(); }

std::vector<size_t> Reversed(const std::vector<size_t>& tour) {
  return {tour.rbegin(), tour.rend()};
}

}  // namespace

LapOptions LapOf(const TownSpec& spec) { return {.seed = SeedOf(spec, kLap)}; }

Drive::Drive(const TownSpec& spec, const EquirectangularCamera& camera, double fps)
    : spec_(spec),
      camera_(camera),
      fps_(fps),
      light_(MakeLight(spec.light, spec.seed)),
      town_(BuildTown(spec.seed, spec.plan)),
      sky_(light_, spec.seed),
      scene_(town_.scenery),
      shader_(town_.scenery.palette, light_, sky_),
      lap_(town_.plan, town_.plan.tour, LapOf(spec)),
      oncoming_lap_(town_.plan, Reversed(town_.plan.tour), {.seed = SeedOf(spec, kOncomingLap)}),
      traffic_(town_, lap_, oncoming_lap_,
               {.seed = SeedOf(spec, kTraffic), .density = spec.traffic}) {
  BakeOpenness(scene_, &town_.scenery);
  motion_.seed = SeedOf(spec, kShaking);
  motion_.height = Random(SeedOf(spec, kCameraHeight)).Uniform(1.8, 2.2);
}

Rigid3 Drive::WorldFromCamera(int frame) const { return CameraPose(lap_, motion_, TimeOf(frame)); }

FrameScene Drive::SceneAt(int frame) const {
  return FrameScene(scene_, traffic_.At(TimeOf(frame)));
}

cv::Mat3b Drive::Colour(const FrameScene& scene, int frame) const {
  return RenderColour(scene, shader_, camera_, WorldFromCamera(frame));
}

GeometryImage Drive::Geometry(const FrameScene& scene, int frame) const {
  return RenderGeometry(scene, camera_, WorldFromCamera(frame));
}

}  // namespace orb360::town
