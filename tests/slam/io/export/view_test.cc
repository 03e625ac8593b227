#include "slam/io/export/view.h"

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(View, EachFaceOfTheCubeLooksWhereItsNameSays) {
  // Optical frame: x right, y down, z forward.
  const std::map<std::string, Eigen::Vector3d> forward = {
      {"front", {0, 0, 1}}, {"right", {1, 0, 0}}, {"back", {0, 0, -1}},
      {"left", {-1, 0, 0}}, {"up", {0, -1, 0}},   {"down", {0, 1, 0}}};
  const std::vector<View> views = CubeViews(1024, 96 * kDegree);
  ASSERT_EQ(views.size(), 6u);
  EXPECT_EQ(views.front().name, "front");
  EXPECT_TRUE(views.front().view_from_optical.isApprox(Eigen::Quaterniond::Identity()));
  for (const View& view : views) {
    const auto pixel = ProjectToView(view, forward.at(view.name));
    ASSERT_TRUE(pixel.has_value()) << view.name;
    EXPECT_NEAR(pixel->x(), 0.5 * view.width, 1e-9) << view.name;
    EXPECT_NEAR(pixel->y(), 0.5 * view.height, 1e-9) << view.name;
    EXPECT_FALSE(ProjectToView(view, -forward.at(view.name)).has_value()) << view.name;
  }
  // What is above the horizon is in the upper half of the four sides; a point ahead is at the
  // bottom of `up` and at the top of `down`.
  for (size_t v = 0; v < 4; ++v) {
    const Eigen::Vector3d above = forward.at(views[v].name) - Eigen::Vector3d(0, 0.2, 0);
    EXPECT_LT(ProjectToView(views[v], above)->y(), 0.42 * views[v].height);
  }
  EXPECT_GT(ProjectToView(views[4], {0, -1, 0.5})->y(), 0.6 * views[4].height);
  EXPECT_LT(ProjectToView(views[5], {0, 1, 0.5})->y(), 0.4 * views[5].height);
}

TEST(View, FacesHaveTheResolutionOfTheHorizonAndTheFieldOfViewAskedFor) {
  const View face = CubeViews(4096, 96 * kDegree).front();
  const View panorama = PanoramaView(4096, 2048).front();
  // A pixel of the panorama at its centre is a pixel of the face.
  const Eigen::Vector3d beside = DirectionOfPixel(panorama, {2049, 1024});
  EXPECT_NEAR(ProjectToView(face, beside)->x() - 0.5 * face.width, 1.0, 1e-5);
  EXPECT_NEAR(2 * std::atan(0.5 * face.width / face.focal) / kDegree, 96, 0.05);
  EXPECT_EQ(face.width % 2, 0);
}

TEST(View, ADirectionAndItsPixelAreInverseInEveryView) {
  RandomGeometry random(3);
  std::vector<View> views = CubeViews(2048, 96 * kDegree);
  views.push_back(PanoramaView(2048, 1024).front());
  for (const View& view : RingViews(2048, 5, 80 * kDegree)) views.push_back(view);
  for (const View& view : views) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector2d pixel(random.Uniform(0, view.width), random.Uniform(0, view.height));
      const Eigen::Vector3d direction = DirectionOfPixel(view, pixel);
      EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
      EXPECT_LT((*ProjectToView(view, 7 * direction) - pixel).norm(), 1e-6) << view.name;
    }
  }
}

TEST(View, EveryDirectionIsInAFaceOfTheCubeAndSomeInTwo) {
  RandomGeometry random(4);
  const std::vector<View> views = CubeViews(1024, 96 * kDegree);
  int in_several = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d direction = random.Point(1.0, 2.0);
    int faces = 0;
    for (const View& view : views) {
      const auto pixel = ProjectToView(view, direction);
      faces += pixel && ContainsPixel(view, *pixel) ? 1 : 0;
    }
    EXPECT_GE(faces, 1);
    in_several += faces > 1 ? 1 : 0;
  }
  EXPECT_GT(in_several, 100);
  EXPECT_LT(in_several, 1000);
}

TEST(View, ARingGoesFromTheFrontToTheRight) {
  const std::vector<View> views = RingViews(1024, 8, 60 * kDegree);
  ASSERT_EQ(views.size(), 8u);
  EXPECT_EQ(views[2].name, "view_02");
  const Eigen::Vector2d middle(0.5 * views[2].width, 0.5 * views[2].height);
  EXPECT_LT((DirectionOfPixel(views[2], middle) - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

}  // namespace
}  // namespace orb360
