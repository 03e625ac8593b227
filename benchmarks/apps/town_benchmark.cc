// Rays per second of the town renderer beside a bare Embree loop that traces the same primary rays
// and one shadow ray for each hit but shades nothing. Panoramas 1024 and 2048 pixels wide, with 4
// samples a pixel.
#include <array>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "apps/town/drive/camera_motion.h"
#include "apps/town/render/geometry_image.h"
#include "apps/town/render/renderer.h"
#include "apps/town/world/town.h"

namespace orb360::town {
namespace {

struct World {
  Town town = BuildTown(1);
  Light light = MakeLight("noon", 1);
  Sky sky{light, 1};
  RayScene scene{town.scenery};
  Shader shader{town.scenery.palette, light, sky};
  FrameScene frame{scene, {}};
  Lap lap{town.plan, town.plan.tour, {}};

  Rigid3 Pose(int i) const { return CameraPose(lap, {}, 5.0 * i); }
};

const World& TheWorld() {
  static const World world;
  return world;
}

EquirectangularCamera Camera(const benchmark::State& state) {
  const auto width = static_cast<int>(state.range(0));
  return {width, width / 2};
}

void CountSamples(const EquirectangularCamera& camera, benchmark::State* state) {
  state->counters["samples/s"] = benchmark::Counter(
      4.0 * camera.width() * camera.height() * static_cast<double>(state->iterations()),
      benchmark::Counter::kIsRate);
}

void RenderColours(benchmark::State& state, Sampling sampling) {
  const World& world = TheWorld();
  const EquirectangularCamera camera = Camera(state);
  int frame = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        RenderColour(world.frame, world.shader, camera, world.Pose(frame), sampling));
    ++frame;
  }
  CountSamples(camera, &state);
}
BENCHMARK_CAPTURE(RenderColours, adaptive, Sampling::kAdaptive)
    ->Arg(1024)
    ->Arg(2048)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(RenderColours, full, Sampling::kFull)
    ->Arg(1024)
    ->Arg(2048)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void BM_RenderGeometry(benchmark::State& state) {
  const World& world = TheWorld();
  const EquirectangularCamera camera = Camera(state);
  int frame = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(RenderGeometry(world.frame, camera, world.Pose(frame)));
    ++frame;
  }
}
BENCHMARK(BM_RenderGeometry)->Arg(1024)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Packets of four pixels in a row, four samples each, then the shadow rays of those that hit.
void BM_BareEmbree(benchmark::State& state) {
  const World& world = TheWorld();
  const EquirectangularCamera camera = Camera(state);
  const EquirectangularCamera samples(2 * camera.width(), 2 * camera.height());
  int frame = 0;
  for (auto _ : state) {
    const Rigid3 pose = world.Pose(frame);
    const Vector3f origin = pose.translation.cast<float>();
    std::vector<Vector3f> horizontal;
    for (int u = 0; u < samples.width(); ++u)
      horizontal.push_back(
          (pose.rotation * samples.Bearing({u + 0.5, samples.cy()})).cast<float>());
    const Vector3f up = (pose.rotation * Eigen::Vector3d::UnitZ()).cast<float>();
#pragma omp parallel for schedule(dynamic, 2)
    for (int row = 0; row < camera.height(); ++row) {
      RTCRayHit16 rays;
      RTCRay16 shadows;
      alignas(64) std::array<int, 16> valid;
      for (int column = 0; column < samples.width(); column += 8) {
        for (int lane = 0; lane < 16; ++lane) {
          const Eigen::Vector3d latitude =
              samples.Bearing({samples.cx(), 2 * row + lane / 8 + 0.5});
          const Vector3f d = static_cast<float>(-latitude.x()) *
                                 horizontal[static_cast<size_t>(column + lane % 8)] +
                             static_cast<float>(latitude.z()) * up;
          SetRay(rays.ray, lane, origin, d, 3000);
          rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
          rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
          valid[static_cast<size_t>(lane)] = -1;
        }
        world.scene.Intersect(valid.data(), &rays);
        shadows = rays.ray;
        for (int lane = 0; lane < 16; ++lane) {
          valid[static_cast<size_t>(lane)] =
              rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID ? 0 : -1;
          const float t = rays.ray.tfar[lane] * 0.9999F;
          shadows.org_x[lane] += t * rays.ray.dir_x[lane];
          shadows.org_y[lane] += t * rays.ray.dir_y[lane];
          shadows.org_z[lane] += t * rays.ray.dir_z[lane];
          shadows.dir_x[lane] = world.light.to_sun.x();
          shadows.dir_y[lane] = world.light.to_sun.y();
          shadows.dir_z[lane] = world.light.to_sun.z();
          shadows.tfar[lane] = 3000;
        }
        world.scene.Occluded(valid.data(), &shadows);
        benchmark::DoNotOptimize(shadows.tfar[0]);
      }
    }
    ++frame;
  }
  CountSamples(camera, &state);
}
BENCHMARK(BM_BareEmbree)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace orb360::town
