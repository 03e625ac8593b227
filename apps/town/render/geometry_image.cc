#include "apps/town/render/geometry_image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/town/render/ray_directions.h"
#include "apps/town/render/ray_packet.h"

namespace orb360::town {
namespace {

constexpr std::array<std::array<double, 2>, 1> kCentre = {{{0.5, 0.5}}};

GeometryImage Geometry(const FrameScene& scene, const RayDirections& directions,
                       const Vector3f& eye) {
  constexpr int kSide = RayDirections::kSquare;
  GeometryImage image{cv::Mat1f(directions.height(), directions.width()),
                      cv::Mat1w(directions.height(), directions.width())};
#pragma omp parallel for schedule(dynamic, 1)
  for (int top = 0; top < image.range.rows; top += kSide) {
    EyePacket packet;
    Lanes3 square;
    for (int left = 0; left < image.range.cols; left += kSide) {
      directions.OfSquare(left, top, 0, &square);
      packet.Trace(scene, eye, square);
      for (int lane = 0; lane < kPacket; ++lane) {
        const int row = top + lane / kSide;
        const int column = left + lane % kSide;
        if (row >= image.range.rows || column >= image.range.cols) continue;
        image.object(row, column) = scene.ObjectId(packet.hit(), lane);
        image.range(row, column) = packet.Hits(lane) ? packet.range(lane) : 0;
      }
    }
  }
  return image;
}

}  // namespace

GeometryImage RenderGeometry(const FrameScene& scene, const EquirectangularCamera& camera,
                             const Rigid3& world_from_camera) {
  return Geometry(scene, RayDirections::OfPanorama(camera, world_from_camera.rotation, kCentre),
                  world_from_camera.translation.cast<float>());
}

CubeImages<float> RenderCubeDepth(const FrameScene& scene, int size,
                                  const Rigid3& world_from_camera) {
  CubeImages<float> faces;
  for (int face = 0; face < kCubeFaces; ++face) {
    cv::Mat1f depth =
        Geometry(scene,
                 RayDirections::OfCubeFace(size, world_from_camera.rotation * CameraFromFace(face),
                                           kCentre),
                 world_from_camera.translation.cast<float>())
            .range;
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const double right = 2 * (column + 0.5) / size - 1;
        const double up = 1 - 2 * (row + 0.5) / size;
        depth(row, column) /= static_cast<float>(std::sqrt(1 + right * right + up * up));
      }
    }
    faces[static_cast<size_t>(face)] = depth;
  }
  return faces;
}

}  // namespace orb360::town
