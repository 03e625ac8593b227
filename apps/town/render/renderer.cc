#include "apps/town/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/town/render/tone.h"

namespace orb360::town {
namespace {

/// Builds an image of the pixels that `encode` makes of radiance.
template <typename Encode>
auto RenderImage(const FrameScene& scene, const Shader& shader, const RayDirections& directions,
                 const Vector3f& eye, double pixel_angle, Sampling sampling, const Encode& encode) {
  const auto sample_angle =
      static_cast<float>(pixel_angle / std::sqrt(static_cast<double>(kSamples)));
  cv::Mat_<decltype(encode(Vector3f()))> image(directions.height(), directions.width());
  const int across = (image.cols - 1) / TileRenderer::kWidth + 1;
  const int tiles = across * ((image.rows - 1) / TileRenderer::kHeight + 1);
#pragma omp parallel
  {
    TileRenderer renderer(scene, shader, directions, eye, sample_angle, sampling);
#pragma omp for schedule(dynamic, 1)
    for (int i = 0; i < tiles; ++i) {
      const cv::Rect tile =
          cv::Rect(i % across * TileRenderer::kWidth, i / across * TileRenderer::kHeight,
                   TileRenderer::kWidth, TileRenderer::kHeight) &
          cv::Rect({0, 0}, image.size());
      renderer.Render(tile);
      for (int row = tile.y; row < tile.y + tile.height; ++row) {
        for (int column = tile.x; column < tile.x + tile.width; ++column)
          image(row, column) = encode(renderer.At(column, row));
      }
    }
  }
  return image;
}

cv::Vec3f BlueGreenRed(const Vector3f& radiance) {
  return {radiance.z(), radiance.y(), radiance.x()};
}

template <typename Encode>
auto RenderPanorama(const FrameScene& scene, const Shader& shader,
                    const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                    Sampling sampling, const Encode& encode) {
  return RenderImage(
      scene, shader, RayDirections::OfPanorama(camera, world_from_camera.rotation, kSamplePattern),
      world_from_camera.translation.cast<float>(), camera.AngleOfPixels(1), sampling, encode);
}

template <typename Pixel, typename Encode>
CubeImages<Pixel> RenderCube(const FrameScene& scene, const Shader& shader, int size,
                             const Rigid3& world_from_camera, Sampling sampling,
                             const Encode& encode) {
  CubeImages<Pixel> faces;
  for (int face = 0; face < kCubeFaces; ++face) {
    const Eigen::Quaterniond world_from_face = world_from_camera.rotation * CameraFromFace(face);
    // The angle of a pixel in the middle of a side, between those of the centre and the corners.
    faces[static_cast<size_t>(face)] = RenderImage(
        scene, shader, RayDirections::OfCubeFace(size, world_from_face, kSamplePattern),
        world_from_camera.translation.cast<float>(), std::numbers::pi / 2 / size, sampling, encode);
  }
  return faces;
}

}  // namespace

cv::Mat3b RenderColour(const FrameScene& scene, const Shader& shader,
                       const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                       Sampling sampling) {
  const ToneCurve tone;
  return RenderPanorama(scene, shader, camera, world_from_camera, sampling,
                        [&](const Vector3f& radiance) { return tone.Encode(radiance); });
}

cv::Mat3f RenderRadiance(const FrameScene& scene, const Shader& shader,
                         const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                         Sampling sampling) {
  return RenderPanorama(scene, shader, camera, world_from_camera, sampling, BlueGreenRed);
}

CubeImages<cv::Vec3b> RenderCubeColour(const FrameScene& scene, const Shader& shader, int size,
                                       const Rigid3& world_from_camera, Sampling sampling) {
  const ToneCurve tone;
  return RenderCube<cv::Vec3b>(scene, shader, size, world_from_camera, sampling,
                               [&](const Vector3f& radiance) { return tone.Encode(radiance); });
}

CubeImages<cv::Vec3f> RenderCubeRadiance(const FrameScene& scene, const Shader& shader, int size,
                                         const Rigid3& world_from_camera, Sampling sampling) {
  return RenderCube<cv::Vec3f>(scene, shader, size, world_from_camera, sampling, BlueGreenRed);
}

}  // namespace orb360::town
