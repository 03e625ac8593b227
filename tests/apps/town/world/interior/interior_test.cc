#include "apps/town/world/interior/interior.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "apps/town/drive/indoor_walk.h"
#include "apps/town/render/ray_scene.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

InteriorMaterials PlainInteriorMaterials() {
  InteriorMaterials m{};
  static_cast<Materials&>(m) = NamedPlainMaterials();
  for (auto* list : {&m.wallpapers, &m.planks, &m.floor_tiles, &m.wall_tiles, &m.terrazzos,
                     &m.carpets, &m.cloths, &m.books, &m.cartons, &m.pictures, &m.screens})
    list->push_back(0);
  return m;
}

Interior PlainInterior(uint64_t seed) {
  return BuildInterior(seed, static_cast<BuildingKind>(seed % kBuildingKinds),
                       PlainInteriorMaterials());
}

/// Traces one ray. Returns whether it hits the building, and how far away.
struct Hit {
  bool is_building = false;
  float range = 0;
};
Hit Trace(const FrameScene& scene, const Vector3f& origin, const Vector3f& direction) {
  RTCRayHit16 rays{};
  alignas(64) std::array<int, kPacket> valid{};
  for (int lane = 0; lane < kPacket; ++lane) {
    SetRay(rays.ray, lane, origin, direction, lane == 0 ? 1000.0F : -1.0F);
    rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  valid[0] = -1;
  scene.Intersect(valid.data(), &rays);
  if (rays.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) return {};
  return {scene.Resolve(rays.hit, 0).instance == nullptr, rays.ray.tfar[0]};
}

bool PassesAWindow(const Interior& interior, const Vector3f& origin, const Vector3f& direction) {
  for (const Lamp& lamp : interior.scenery.lamps) {
    if (!lamp.is_window) continue;
    const Vector3f across = lamp.first_side.cross(lamp.second_side);
    const float along = direction.dot(across);
    if (along >= 0) continue;
    const Vector3f at =
        origin + (lamp.corner - origin).dot(across) / along * direction - lamp.corner;
    const float x = at.dot(lamp.first_side) / lamp.first_side.squaredNorm();
    const float y = at.dot(lamp.second_side) / lamp.second_side.squaredNorm();
    if (std::min(x, y) > -0.02F && std::max(x, y) < 1.02F) return true;
  }
  return false;
}

TEST(InteriorSlow, IsClosedExceptForItsWindows) {
  for (uint64_t seed = 0; seed < 24; ++seed) {
    const Interior interior = PlainInterior(seed);
    const RayScene scene(interior.scenery);
    const FrameScene still(scene, {});
    Random random(seed);
    for (const Room& room : interior.plan.rooms) {
      for (int i = 0; i < 300; ++i) {
        const Vector3f origin(
            static_cast<float>(random.Uniform(room.area.x0 + 0.05, room.area.x1 - 0.05)),
            static_cast<float>(random.Uniform(room.area.y0 + 0.05, room.area.y1 - 0.05)),
            static_cast<float>(random.Uniform(0.1, room.height - 0.1)));
        const Vector3f direction =
            Vector3f(static_cast<float>(random.Gaussian()), static_cast<float>(random.Gaussian()),
                     static_cast<float>(random.Gaussian()))
                .normalized();
        if (Trace(still, origin, direction).is_building) continue;
        EXPECT_TRUE(PassesAWindow(interior, origin, direction))
            << "seed " << seed << " from " << origin.transpose() << " to " << direction.transpose();
      }
    }
  }
}

TEST(InteriorSlow, IsWalkedClearOfWallsAndFurniture) {
  for (uint64_t seed = 100; seed < 136; ++seed) {
    const Interior interior = PlainInterior(seed);
    const RayScene scene(interior.scenery);
    const FrameScene still(scene, {});
    const IndoorWalk walk(interior.plan, interior.taken, {}, Random(seed));
    EXPECT_GE(walk.duration(), 60) << seed;
    double longest = 0;
    for (double time = 0; time < 60; time += 0.1) {
      const WalkState state = walk.At(time);
      longest = std::max(longest, (walk.At(time + 0.1).position - state.position).norm());
      for (const float height : {0.35F, 0.9F, 1.5F, 1.85F}) {
        for (int i = 0; i < 12; ++i) {
          const float angle = std::numbers::pi_v<float> * static_cast<float>(i) / 6;
          const Vector3f origin(static_cast<float>(state.position.x()),
                                static_cast<float>(state.position.y()), height);
          const Hit hit = Trace(still, origin, {std::cos(angle), std::sin(angle), 0});
          // What hangs over or leans out a little is not in the plan of the furniture.
          if (!hit.is_building) continue;
          EXPECT_GT(hit.range, 0.2F) << "seed " << seed << " at " << origin.transpose();
        }
      }
    }
    EXPECT_LE(longest, 0.11) << seed;
  }
}

TEST(InteriorSlow, IsWalkedThroughAllItsRooms) {
  int rooms = 0;
  int visited = 0;
  for (uint64_t seed = 200; seed < 224; ++seed) {
    const Interior interior = PlainInterior(seed);
    const IndoorWalk walk(interior.plan, interior.taken, {1, 600}, Random(seed));
    for (const Room& room : interior.plan.rooms) {
      ++rooms;
      for (double time = 0; time < walk.duration(); time += 0.5) {
        if (!room.area.Contains(walk.At(time).position.cast<float>())) continue;
        ++visited;
        break;
      }
    }
  }
  EXPECT_GT(visited, 0.9 * rooms);
}

}  // namespace
}  // namespace orb360::town
