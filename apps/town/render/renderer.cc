#include "apps/town/render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "apps/town/render/ray_directions.h"
#include "apps/town/render/tone.h"

namespace orb360::town {
namespace {

constexpr int kSamples = 4;                  // per pixel
constexpr int kPixels = kPacket / kSamples;  // per packet, in a row
constexpr float kFar = 3000.0F;              // metres
constexpr float kSunRadius = 0.0047F;        // radians
constexpr float kMaximumRadiance = 5.0F;     // keeps one bright sample from outshining a pixel
/// Positions of the samples in a pixel: a rotated grid, so that edges near the horizontal and
/// the vertical take all four shades.
constexpr std::array<std::array<double, 2>, kSamples> kPattern = {
    {{0.125, 0.375}, {0.375, 0.875}, {0.625, 0.125}, {0.875, 0.625}}};
/// Spread over a mip level, so that the mean of a pixel's samples is filtered trilinearly.
constexpr std::array<float, kSamples> kLevelOffset = {0.125F, 0.625F, 0.875F, 0.375F};

/// A packet of rays from the camera that have met nothing yet.
void PrepareRays(const RayDirections& directions, int column, int row, const Vector3f& origin,
                 RTCRayHit16* rays) {
  directions.Fill(column, row, &rays->ray);
  for (int lane = 0; lane < kPacket; ++lane) {
    rays->ray.org_x[lane] = origin.x();
    rays->ray.org_y[lane] = origin.y();
    rays->ray.org_z[lane] = origin.z();
    rays->ray.tnear[lane] = 0;
    rays->ray.tfar[lane] = kFar;
    rays->ray.time[lane] = 0;
    rays->ray.mask[lane] = ~0U;
    rays->ray.id[lane] = 0;
    rays->ray.flags[lane] = 0;
    rays->hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    rays->hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
}

/// Whether two lanes of a packet lie on the same flat piece of one mesh, so that they can share
/// what is looked up for a surface.
bool SameSurface(const RTCHit16& hit, int i, int j, const SurfaceHit& a, const SurfaceHit& b) {
  if (a.mesh != b.mesh || a.instance != b.instance || a.triangle->material != b.triangle->material)
    return false;
  const float dot =
      hit.Ng_x[i] * hit.Ng_x[j] + hit.Ng_y[i] * hit.Ng_y[j] + hit.Ng_z[i] * hit.Ng_z[j];
  const float squared_i =
      hit.Ng_x[i] * hit.Ng_x[i] + hit.Ng_y[i] * hit.Ng_y[i] + hit.Ng_z[i] * hit.Ng_z[i];
  const float squared_j =
      hit.Ng_x[j] * hit.Ng_x[j] + hit.Ng_y[j] * hit.Ng_y[j] + hit.Ng_z[j] * hit.Ng_z[j];
  return dot > 0 && dot * dot > 0.98F * squared_i * squared_j;  // within 8 degrees
}

/// Traces and shades packets of kPixels pixels in a row. Samples of a pixel that meet the same
/// surface share its description and its lighting; each has its own texture sample and its own
/// ray to the sun.
class PacketRenderer {
 public:
  PacketRenderer(const FrameScene& scene, const Shader& shader, const RayDirections& directions,
                 const Vector3f& origin, float sample_angle)
      : scene_(&scene),
        shader_(&shader),
        directions_(&directions),
        origin_(origin),
        sample_angle_(sample_angle),
        has_sun_(shader.light().sun.maxCoeff() > 0) {
    // Points of the sun's disc, one for each sample of a pixel.
    const Vector3f& to_sun = shader.light().to_sun;
    const Vector3f x = to_sun.unitOrthogonal();
    const Vector3f y = to_sun.cross(x);
    for (size_t i = 0; i < kSamples; ++i) {
      const float turn = 2.39996F * static_cast<float>(i);  // the golden angle
      const float radius = kSunRadius * std::sqrt((static_cast<float>(i) + 0.5F) / kSamples);
      to_sun_[i] = to_sun + radius * (std::cos(turn) * x + std::sin(turn) * y);
    }
  }

  void Render(int column, int row, std::array<Vector3f, kPixels>* result) {
    PrepareRays(*directions_, column, row, origin_, &rays_);
    valid_.fill(-1);
    scene_->Intersect(valid_.data(), &rays_);
    patch_count_ = 0;
    valid_.fill(0);
    for (int pixel = 0; pixel < kPixels; ++pixel) DescribePixel(pixel);
    if (std::any_of(valid_.begin(), valid_.end(), [](int valid) { return valid != 0; }))
      scene_->Occluded(valid_.data(), &shadows_);
    for (int pixel = 0; pixel < kPixels; ++pixel)
      (*result)[static_cast<size_t>(pixel)] = ShadePixel(pixel);
  }

 private:
  /// The part of a pixel that one surface fills.
  struct Patch {
    Surface surface;
    SurfaceHit hit;
    Vector3f lift;                       ///< from the surface to where rays to the sun start
    Vector3f colour = Vector3f::Zero();  ///< sum of its samples' texture colours
    int first_lane = 0;
    int samples = 0;
  };

  Vector3f Direction(int lane) const {
    return {rays_.ray.dir_x[lane], rays_.ray.dir_y[lane], rays_.ray.dir_z[lane]};
  }

  Patch NewPatch(const SurfaceHit& hit, int lane) const {
    const Vector3f direction = Direction(lane);
    const float range = rays_.ray.tfar[lane];
    Patch patch;
    patch.hit = hit;
    patch.first_lane = lane;
    patch.surface = shader_->Describe(hit, rays_.hit.u[lane], rays_.hit.v[lane], direction,
                                      range * sample_angle_);
    const Vector3f geometric = scene_->GeometricNormal(rays_.hit, lane).normalized();
    const float side = geometric.dot(direction) > 0 ? -1.0F : 1.0F;
    patch.lift = side * (2e-3F + 1e-5F * range) *
                 geometric;  // metres; well above the rounding of coordinates
    return patch;
  }

  /// Sorts the pixel's samples into patches and sets up their rays to the sun.
  void DescribePixel(int pixel) {
    const size_t first_patch = patch_count_;
    for (int lane = pixel * kSamples; lane < (pixel + 1) * kSamples; ++lane) {
      const auto index = static_cast<size_t>(lane);
      patch_of_[index] = kNoPatch;
      if (rays_.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      const SurfaceHit hit = scene_->Resolve(rays_.hit, lane);
      size_t p = first_patch;
      while (p < patch_count_ &&
             !SameSurface(rays_.hit, patches_[p].first_lane, lane, patches_[p].hit, hit))
        ++p;
      if (p == patch_count_) patches_[patch_count_++] = NewPatch(hit, lane);
      Patch& patch = patches_[p];
      patch_of_[index] = p;
      ++patch.samples;
      patch.colour += shader_->Colour(patch.surface, hit, rays_.hit.u[lane], rays_.hit.v[lane],
                                      kLevelOffset[index % kSamples]);
      if (!has_sun_ || patch.surface.sun_cosine <= 0) continue;
      const Vector3f point = origin_ + rays_.ray.tfar[lane] * Direction(lane) + patch.lift;
      SetRay(shadows_, lane, point, to_sun_[index % kSamples], kFar);
      valid_[index] = -1;
    }
  }

  Vector3f ShadePixel(int pixel) const {
    Vector3f sum = Vector3f::Zero();
    for (int lane = pixel * kSamples; lane < (pixel + 1) * kSamples; ++lane) {
      const size_t p = patch_of_[static_cast<size_t>(lane)];
      if (p == kNoPatch) {
        sum += shader_->sky().Radiance(Direction(lane)).cwiseMin(kMaximumRadiance);
      } else if (patches_[p].first_lane == lane) {
        sum += ShadePatch(p, pixel);
      }
    }
    return sum * (1.0F / kSamples);
  }

  /// A patch's radiance times its number of samples.
  Vector3f ShadePatch(size_t p, int pixel) const {
    const Patch& patch = patches_[p];
    int sunlit = 0;
    for (int lane = pixel * kSamples; lane < (pixel + 1) * kSamples; ++lane) {
      const auto index = static_cast<size_t>(lane);
      if (patch_of_[index] == p && valid_[index] != 0 && shadows_.tfar[lane] >= 0) ++sunlit;
    }
    const auto samples = static_cast<float>(patch.samples);
    const Vector3f radiance = shader_->Radiance(
        patch.surface, patch.colour / samples, static_cast<float>(sunlit) / samples,
        Direction(patch.first_lane), rays_.ray.tfar[patch.first_lane]);
    return samples * radiance.cwiseMin(kMaximumRadiance);
  }

  static constexpr size_t kNoPatch = kPacket;

  const FrameScene* scene_;
  const Shader* shader_;
  const RayDirections* directions_;
  Vector3f origin_;
  float sample_angle_;
  bool has_sun_;
  std::array<Vector3f, kSamples> to_sun_;
  RTCRayHit16 rays_;
  RTCRay16 shadows_;
  alignas(64) std::array<int, kPacket> valid_;
  std::array<Patch, kPacket> patches_;
  std::array<size_t, kPacket> patch_of_;
  size_t patch_count_ = 0;
};

/// A picture made of the pixels that `encode` makes of radiance.
template <typename Encode>
auto Picture(const FrameScene& scene, const Shader& shader, const RayDirections& directions,
             const Vector3f& origin, double pixel_angle, const Encode& encode) {
  const auto sample_angle = static_cast<float>(pixel_angle / std::sqrt(kSamples));
  cv::Mat_<decltype(encode(Vector3f()))> image(directions.height(), directions.width());
#pragma omp parallel
  {
    PacketRenderer packet(scene, shader, directions, origin, sample_angle);
    std::array<Vector3f, kPixels> colours;
#pragma omp for schedule(dynamic, 2)
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.cols; column += kPixels) {
        const int first = std::min(column, image.cols - kPixels);
        packet.Render(first, row, &colours);
        for (int i = 0; i < kPixels; ++i)
          image(row, first + i) = encode(colours[static_cast<size_t>(i)]);
      }
    }
  }
  return image;
}

GeometryImage Geometry(const FrameScene& scene, const RayDirections& directions,
                       const Vector3f& origin) {
  GeometryImage image{cv::Mat1f(directions.height(), directions.width()),
                      cv::Mat1w(directions.height(), directions.width())};
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < image.range.rows; ++row) {
    RTCRayHit16 rays;
    alignas(64) std::array<int, kPacket> valid;
    for (int column = 0; column < image.range.cols; column += kPacket) {
      const int pixels = std::min(kPacket, image.range.cols - column);
      for (int lane = 0; lane < kPacket; ++lane)
        valid[static_cast<size_t>(lane)] = lane < pixels ? -1 : 0;
      PrepareRays(directions, column, row, origin, &rays);
      scene.Intersect(valid.data(), &rays);
      for (int lane = 0; lane < pixels; ++lane) {
        image.object(row, column + lane) = scene.ObjectId(rays.hit, lane);
        image.range(row, column + lane) =
            rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID ? 0 : rays.ray.tfar[lane];
      }
    }
  }
  return image;
}

constexpr std::array<std::array<double, 2>, 1> kCentre = {{{0.5, 0.5}}};

RayDirections FaceDirections(int face, int size, const Rigid3& world_from_camera,
                             RayDirections::Pattern pattern) {
  return RayDirections::OfCubeFace(size, world_from_camera.rotation * CameraFromFace(face),
                                   pattern);
}

cv::Vec3f BlueGreenRed(const Vector3f& radiance) {
  return {radiance.z(), radiance.y(), radiance.x()};
}

template <typename Encode>
auto PanoramaPicture(const FrameScene& scene, const Shader& shader,
                     const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                     const Encode& encode) {
  return Picture(scene, shader,
                 RayDirections::OfPanorama(camera, world_from_camera.rotation, kPattern),
                 world_from_camera.translation.cast<float>(), camera.AngleOfPixels(1), encode);
}

template <typename Pixel, typename Encode>
CubeImages<Pixel> CubePictures(const FrameScene& scene, const Shader& shader, int size,
                               const Rigid3& world_from_camera, const Encode& encode) {
  CubeImages<Pixel> faces;
  for (int face = 0; face < kCubeFaces; ++face) {
    // The angle of a pixel in the middle of a side, between those of the centre and the corners.
    faces[static_cast<size_t>(face)] =
        Picture(scene, shader, FaceDirections(face, size, world_from_camera, kPattern),
                world_from_camera.translation.cast<float>(), std::numbers::pi / 2 / size, encode);
  }
  return faces;
}

}  // namespace

cv::Mat3b RenderColour(const FrameScene& scene, const Shader& shader,
                       const EquirectangularCamera& camera, const Rigid3& world_from_camera) {
  const ToneCurve tone;
  return PanoramaPicture(scene, shader, camera, world_from_camera,
                         [&](const Vector3f& radiance) { return tone.Encode(radiance); });
}

cv::Mat3f RenderRadiance(const FrameScene& scene, const Shader& shader,
                         const EquirectangularCamera& camera, const Rigid3& world_from_camera) {
  return PanoramaPicture(scene, shader, camera, world_from_camera, BlueGreenRed);
}

GeometryImage RenderGeometry(const FrameScene& scene, const EquirectangularCamera& camera,
                             const Rigid3& world_from_camera) {
  return Geometry(scene, RayDirections::OfPanorama(camera, world_from_camera.rotation, kCentre),
                  world_from_camera.translation.cast<float>());
}

CubeImages<cv::Vec3b> RenderCubeColour(const FrameScene& scene, const Shader& shader, int size,
                                       const Rigid3& world_from_camera) {
  const ToneCurve tone;
  return CubePictures<cv::Vec3b>(scene, shader, size, world_from_camera,
                                 [&](const Vector3f& radiance) { return tone.Encode(radiance); });
}

CubeImages<cv::Vec3f> RenderCubeRadiance(const FrameScene& scene, const Shader& shader, int size,
                                         const Rigid3& world_from_camera) {
  return CubePictures<cv::Vec3f>(scene, shader, size, world_from_camera, BlueGreenRed);
}

CubeImages<float> RenderCubeDepth(const FrameScene& scene, int size,
                                  const Rigid3& world_from_camera) {
  CubeImages<float> faces;
  for (int face = 0; face < kCubeFaces; ++face) {
    cv::Mat1f depth = Geometry(scene, FaceDirections(face, size, world_from_camera, kCentre),
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
