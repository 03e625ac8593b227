#include "apps/town/world/tunnel/lining.h"

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

TEST(Lining, FacesTheHollowAllRound) {
  const Trail trail(12, Random(1), 0.4F);
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  std::vector<ProfileStrip> profile = ArchedProfile(0, 0, 2, 1.5F, 3, 10);
  profile.push_back({0, {-2, 0}, {2, 0}});
  AddLining(trail, profile, builder);
  const Mesh& mesh = builder.mesh();
  EXPECT_GT(mesh.triangles.size(), 2 * profile.size() * 100);
  for (const Triangle& triangle : mesh.triangles) {
    const Vector3f& p = mesh.positions[triangle.vertices[0]];
    const Vector3f across =
        (mesh.positions[triangle.vertices[1]] - p).cross(mesh.positions[triangle.vertices[2]] - p);
    // The nearest point of the trail, a metre above the floor, is in front of every face.
    size_t nearest = 0;
    for (size_t i = 0; i < trail.points().size(); ++i)
      if ((trail.points()[i] - p.head<2>()).norm() < (trail.points()[nearest] - p.head<2>()).norm())
        nearest = i;
    const Vector2f& middle = trail.points()[nearest];
    EXPECT_GT(across.dot(Vector3f(middle.x(), middle.y(), 1) - p), 0);
  }
}

TEST(Lining, FramesLookAlongTheTrail) {
  const Trail trail(12, Random(1));
  for (const size_t i : {size_t{0}, size_t{50}, trail.points().size() - 1}) {
    const TrailFrame frame = FrameAt(trail, i);
    const Vector2f way = trail.points()[(i + 1) % trail.points().size()] - trail.points()[i];
    EXPECT_GT(frame.along.head<2>().dot(way.normalized()), 0.98F);
    EXPECT_NEAR((frame.right.cross(frame.along) - Vector3f::UnitZ()).norm(), 0, 1e-5F);
  }
}

}  // namespace
}  // namespace orb360::town
