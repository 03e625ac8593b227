#include "apps/town/render/renderer.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "apps/town/render/geometry_image.h"
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

TEST(RenderCube, StitchedItShowsWhatThePanoramaShows) {
  Scenery scenery = PlainScenery();
  MeshBuilder builder(kPlain);
  const Panel panel{{-4, -3, -1}, Vector3f::UnitX(), Vector3f::UnitZ(), Vector3f::UnitY()};
  builder.AddBox(1, panel, 0, 11, 0, 5, 0, 8);
  builder.AddRectangle(1, panel, 0, 11, 0, 5);
  Finish(builder, &scenery);
  const RayScene rays(scenery);
  const FrameScene scene(rays, {});
  const cv::Mat1f range = RenderGeometry(scene, kCamera, Pose()).range;
  const cv::Mat1f stitched = StitchRange(RenderCubeDepth(scene, 192, Pose()), kCamera);
  int close = 0;
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const float truth = range(row, column);
      close += std::abs(stitched(row, column) - truth) < 1e-3F * truth ? 1 : 0;
    }
  }
  EXPECT_GT(close, 0.97 * range.rows * range.cols);  // all but the pixels at edges

  const Light light = MakeLight("noon", 1);
  const Sky sky(light, 1);
  const Shader shader(scenery.palette, light, sky);
  const cv::Mat3b colour = RenderColour(scene, shader, kCamera, Pose());
  const cv::Mat3b joined = StitchColour(RenderCubeColour(scene, shader, 192, Pose()), kCamera);
  EXPECT_LT(cv::norm(colour, joined, cv::NORM_L1) / (3 * colour.total()), 1.0);  // grey levels
}

TEST(RenderColour, AGreyGroundInTheSunIsBrighterThanInTheShadow) {
  Scenery scenery = PlainScenery();
  MeshBuilder builder(kPlain);
  builder.AddGroundPolygon(0, {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}});
  const Light light = MakeLight("noon", 1);
  // A roof whose shadow falls on the point below the camera's left.
  const Vector3f shaded = Vector3f(0.3F, 6, 0);
  const Vector3f roof = shaded + 8 / light.to_sun.z() * light.to_sun;
  builder.AddGroundPolygon(0, {roof + Vector3f(-1, -1, 0), roof + Vector3f(1, -1, 0),
                               roof + Vector3f(1, 1, 0), roof + Vector3f(-1, 1, 0)});
  Finish(builder, &scenery);
  const RayScene scene(scenery);
  const Sky sky(light, 1);
  const cv::Mat3b image =
      RenderColour(FrameScene(scene, {}), Shader(scenery.palette, light, sky), kCamera, Pose());
  const auto green_at = [&](const Eigen::Vector3d& world) {
    const Eigen::Vector2d pixel = kCamera.Project(Pose().Inverse() * world);
    return image(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()))[1];
  };
  EXPECT_GT(green_at({0.3, -6, 0}), 1.3 * green_at(shaded.cast<double>()));
}

TEST(MakeLight, RefusesAnUnknownName) {
  EXPECT_THROW(MakeLight("midnight", 1), std::runtime_error);
}

/// A hall with columns and a canopy under the sun, on chequered ground.
Scenery Hall(const Light& light) {
  Scenery scenery = PlainScenery();
  scenery.palette.textures[0] = Texture::Paint(64, [](float x, float y) {
    return (x < 0.5F) == (y < 0.5F) ? Rgba{0.8F, 0.7F, 0.5F, 1} : Rgba{0.1F, 0.2F, 0.3F, 1};
  });
  MeshBuilder builder(kPlain);
  builder.AddGroundPolygon(1, {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}});
  for (const float x : {-12.0F, -4.0F, 4.0F, 12.0F})
    builder.AddTube(0, {x, 7, 0}, {x, 7, 6}, 0.3F, 0.2F, 16);
  const Vector3f roof = Vector3f(-1, -6, 0) + 8 / light.to_sun.z() * light.to_sun;
  builder.AddGroundPolygon(0, {roof + Vector3f(-2, -2, 0), roof + Vector3f(2, -2, 0),
                               roof + Vector3f(2, 2, 0), roof + Vector3f(-2, 2, 0)});
  Finish(builder, &scenery);
  return scenery;
}

TEST(RenderColour, AdaptiveSamplesShowWhatAllSamplesShow) {
  const EquirectangularCamera camera(1024, 512);
  const Light light = MakeLight("noon", 1);
  const Scenery scenery = Hall(light);
  const RayScene rays(scenery);
  const Sky sky(light, 1);
  const Shader shader(scenery.palette, light, sky);
  const FrameScene scene(rays, {});
  const cv::Mat3b full = RenderColour(scene, shader, camera, Pose(), Sampling::kFull);
  const cv::Mat3b adaptive = RenderColour(scene, shader, camera, Pose(), Sampling::kAdaptive);
  EXPECT_GT(cv::PSNR(full, adaptive), 55);
  cv::Mat differs;
  cv::absdiff(full, adaptive, differs);
  EXPECT_LT(cv::countNonZero(differs.reshape(1) > 8), 0.0002 * 3 * full.total());
}

TEST(RenderColour, AdaptiveSamplesFindTheWholePenumbra) {
  // So fine an image that the penumbra, 8 cm wide, is many pixels.
  const EquirectangularCamera camera(8192, 4096);
  const Light light = MakeLight("noon", 1);
  const Scenery scenery = Hall(light);
  const RayScene rays(scenery);
  const Sky sky(light, 1);
  const Shader shader(scenery.palette, light, sky);
  const FrameScene scene(rays, {});
  const RayDirections directions =
      RayDirections::OfPanorama(camera, Pose().rotation, kSamplePattern);
  const Vector3f eye = Pose().translation.cast<float>();
  const auto angle = static_cast<float>(camera.AngleOfPixels(0.5));
  TileRenderer full(scene, shader, directions, eye, angle, Sampling::kFull);
  TileRenderer adaptive(scene, shader, directions, eye, angle, Sampling::kAdaptive);
  const Eigen::Vector2d edge = camera.Project(Pose().Inverse() * Eigen::Vector3d(1, -6, 0));
  const cv::Rect tile(static_cast<int>(edge.x()) - TileRenderer::kWidth / 2,
                      static_cast<int>(edge.y()) - TileRenderer::kHeight / 2, TileRenderer::kWidth,
                      TileRenderer::kHeight);
  full.Render(tile);
  adaptive.Render(tile);
  float darkest = 1e9F;
  float brightest = 0;
  double difference = 0;
  for (int row = tile.y; row < tile.y + tile.height; ++row) {
    for (int column = tile.x; column < tile.x + tile.width; ++column) {
      const float truth = full.At(column, row).y();
      darkest = std::min(darkest, truth);
      brightest = std::max(brightest, truth);
      difference += std::abs(adaptive.At(column, row).y() - truth);
    }
  }
  EXPECT_GT(brightest, 2 * darkest);  // the shadow's edge is there
  EXPECT_LT(difference / tile.area(), 0.002 * brightest);
}

}  // namespace
}  // namespace orb360::town
