#include "apps/town/render/geometry_image.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

const EquirectangularCamera kCamera(512, 256);

/// A pose without any special alignment.
Rigid3 Pose() {
  Rigid3 pose;
  pose.rotation = ExpSo3({0.1, -0.2, 2.5});
  pose.translation = {0.3, -0.4, 1.7};
  return pose;
}

/// Compares every rendered range with `distance(origin, direction)`, negative where unknown.
void ExpectRanges(
    const Scenery& scenery,
    const std::function<double(const Eigen::Vector3d&, const Eigen::Vector3d&)>& distance,
    int minimum_checked) {
  const RayScene scene(scenery);
  const GeometryImage image = RenderGeometry(FrameScene(scene, {}), kCamera, Pose());
  int checked = 0;
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const Eigen::Vector3d direction =
          Pose().rotation * kCamera.Bearing({column + 0.5, row + 0.5});
      const double truth = distance(Pose().translation, direction);
      if (truth < 0) continue;
      ASSERT_NEAR(image.range(row, column), truth, 1e-3) << column << ' ' << row;
      ++checked;
    }
  }
  EXPECT_GE(checked, minimum_checked);
}

const Materials kPlain = PlainMaterials();

Scenery PlainScenery() {
  Scenery scenery;
  scenery.palette = kPlain;
  return scenery;
}

void Finish(MeshBuilder& builder, Scenery* scenery) {
  scenery->fixed = builder.mesh();
  scenery->fixed.PartitionCutouts(kPlain);
}

TEST(RenderGeometry, RangeToAPlaneIsExactToAMillimetre) {
  Scenery scenery = PlainScenery();
  MeshBuilder builder(kPlain);
  builder.AddGroundPolygon(0, {{-500, -500, 0}, {500, -500, 0}, {500, 500, 0}, {-500, 500, 0}});
  Finish(builder, &scenery);
  const auto distance = [](const Eigen::Vector3d& origin, const Eigen::Vector3d& d) {
    if (d.z() >= 0) return 0.0;
    const double t = -origin.z() / d.z();
    return t < 250 ? t : -1;  // what a 16-bit range image can hold
  };
  ExpectRanges(scenery, distance, 100000);
}

TEST(RenderGeometry, RangeToABoxIsExactToAMillimetre) {
  Scenery scenery = PlainScenery();
  MeshBuilder builder(kPlain);
  const Panel front{{4, -3, -2}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};  // the camera is inside
  builder.AddBox(0, front, 0, 6, 0, 5, -9, 0);
  builder.AddRectangle(0, front, 0, 6, 0, 5, -9);
  Finish(builder, &scenery);
  const auto distance = [](const Eigen::Vector3d& origin, const Eigen::Vector3d& d) {
    double nearest = 1e30;
    const Eigen::Vector3d low(-5, -3, -2);
    const Eigen::Vector3d high(4, 3, 3);
    for (int axis = 0; axis < 3; ++axis) {
      if (d[axis] != 0)
        nearest = std::min(nearest, ((d[axis] > 0 ? high : low)[axis] - origin[axis]) / d[axis]);
    }
    return nearest;
  };
  ExpectRanges(scenery, distance, 512 * 256);
}

/// A box around the origin of its own frame.
Scenery BoxModel() {
  Scenery scenery = PlainScenery();
  MeshBuilder builder(kPlain);
  const Panel panel{{-1, -0.5F, -0.7F}, Vector3f::UnitX(), Vector3f::UnitZ(), -Vector3f::UnitY()};
  builder.AddBox(0, panel, 0, 2, 0, 1.5F, 0, 1);
  scenery.models.push_back(builder.mesh());
  scenery.models.back().PartitionCutouts(kPlain);
  return scenery;
}

TEST(RenderGeometry, AThingIsSeenAlikeWhetherItStandsOrMoves) {
  Instance instance;
  instance.world_from_model = Eigen::Translation3f(2.5F, 1.25F, 0.75F) *
                              Eigen::AngleAxisf(0.7F, Vector3f(1, 2, 3).normalized());
  Scenery with_model = BoxModel();
  Scenery with_instance = with_model;
  with_instance.instances.push_back(instance);
  const RayScene model(with_model);
  const RayScene standing(with_instance);
  const FrameScene moving(model, {instance});
  const GeometryImage a = RenderGeometry(moving, kCamera, Pose());
  const GeometryImage b = RenderGeometry(FrameScene(standing, {}), kCamera, Pose());
  EXPECT_GT(cv::countNonZero(a.range), 1000);
  // Rays along an edge may miss one and meet the other.
  const cv::Mat differs = cv::abs(a.range - b.range) > 1e-3;
  EXPECT_LE(cv::countNonZero(differs), 3);
  EXPECT_EQ(cv::countNonZero(a.object >= moving.first_moving_id()), cv::countNonZero(a.range));
}

TEST(RenderGeometry, RangeToASphereIsExactToAMillimetre) {
  // An instance, so that transforms are tested as well: a unit sphere of fine facets, moved.
  Scenery scenery = PlainScenery();
  MeshBuilder builder(kPlain);
  constexpr int kRings = 600;
  constexpr double kPi = std::numbers::pi;
  const auto at = [](int ring, int side) {
    const double latitude = kPi * (static_cast<double>(ring) / kRings - 0.5);
    const double longitude = kPi * side / kRings;
    return Eigen::Vector3d(std::cos(latitude) * std::cos(longitude),
                           std::cos(latitude) * std::sin(longitude), std::sin(latitude))
        .cast<float>()
        .eval();
  };
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int side = 0; side <= 2 * kRings; ++side) {
      const Vector3f p = at(ring, side);
      builder.AddVertex(p, p, 0, 0);
    }
  }
  for (uint32_t ring = 0; ring < kRings; ++ring) {
    for (uint32_t side = 0; side < 2 * kRings; ++side) {
      const uint32_t a = ring * (2 * kRings + 1) + side;
      builder.AddTriangle(0, a, a + 1, a + 2 * kRings + 2);
      builder.AddTriangle(0, a, a + 2 * kRings + 2, a + 2 * kRings + 1);
    }
  }
  scenery.models.push_back(builder.mesh());
  scenery.models.back().PartitionCutouts(kPlain);
  Instance instance;
  const Eigen::Vector3d centre(2.5, 1.25, 0.75);
  instance.world_from_model = Eigen::Translation3f(centre.cast<float>()) *
                              Eigen::AngleAxisf(0.7F, Vector3f(1, 2, 3).normalized());
  scenery.instances.push_back(instance);
  const auto distance = [&](const Eigen::Vector3d& origin, const Eigen::Vector3d& d) {
    const double along = (centre - origin).dot(d);
    const double squared_off = (centre - origin).squaredNorm() - along * along;
    if (squared_off > 1.001) return 0.0;
    if (squared_off > 0.97) return -1.0;  // grazing: the facets' own error counts
    return along < 0 ? 0.0 : along - std::sqrt(1 - squared_off);
  };
  ExpectRanges(scenery, distance, 100000);
}

TEST(RenderGeometry, CutoutsAreThereOnlyWhereTheTextureCovers) {
  Scenery scenery = PlainScenery();
  MeshBuilder builder(kPlain);
  const Panel wall{{5, 4, -3}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
  builder.AddImage(2, wall, 0, 8, 0, 8);  // covers the half y > 0
  Finish(builder, &scenery);
  const auto distance = [](const Eigen::Vector3d& origin, const Eigen::Vector3d& d) {
    if (d.x() <= 0) return 0.0;
    const Eigen::Vector3d p = origin + (5 - origin.x()) / d.x() * d;
    if (std::abs(p.y()) < 0.01 || std::abs(p.y() - 4) < 0.01 || std::abs(p.z() + 3) < 0.01 ||
        std::abs(p.z() - 5) < 0.01)
      return -1.0;
    return p.y() > 0 && p.y() < 4 && p.z() > -3 && p.z() < 5 ? (p - origin).norm() : 0.0;
  };
  ExpectRanges(scenery, distance, 130000);
}

TEST(RenderGeometry, MovingObjectsHaveTheLastNumbers) {
  Scenery scenery = PlainScenery();
  MeshBuilder ground(kPlain);
  ground.AddGroundPolygon(0, {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}});
  Finish(ground, &scenery);
  MeshBuilder cube(kPlain);
  const Panel front{{0.5, -0.5, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  cube.AddBox(0, front, 0, 1, 0, 1, -1, 0);
  scenery.models.push_back(cube.mesh());
  scenery.models.back().PartitionCutouts(kPlain);
  const auto at = [](float x) {
    Instance instance;
    instance.world_from_model.translation() = Vector3f(x, 0, 0.8F);
    return instance;
  };
  scenery.instances.push_back(at(-6));
  const RayScene scene(scenery);
  const FrameScene frame(scene, {at(6)});
  const GeometryImage image = RenderGeometry(frame, kCamera, Pose());
  const auto id_at = [&](const Eigen::Vector3d& world) {
    const Eigen::Vector2d pixel = kCamera.Project(Pose().Inverse() * world);
    return image.object(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()));
  };
  EXPECT_EQ(id_at({-5.5, 0, 1.3}), FrameScene::kFixed + 1);
  EXPECT_EQ(id_at({5.5, 0, 1.6}), frame.first_moving_id());
  EXPECT_EQ(id_at({0, 6, 0}), FrameScene::kFixed);
  EXPECT_EQ(id_at({0, 6, 9}), FrameScene::kNothing);
}

}  // namespace
}  // namespace orb360::town
