#include "apps/town/render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "apps/town/image/random.h"
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

/// Ray directions in the world, from one table over the columns and one over the rows: with
/// EquirectangularCamera, direction(u, v) = cos(latitude) * horizontal(u) + sin(latitude) * up.
class RayDirections {
 public:
  RayDirections(const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                const std::vector<std::array<double, 2>>& pattern)
      : pattern_size_(pattern.size()) {
    up_ = (world_from_camera.rotation * Eigen::Vector3d::UnitZ()).cast<float>();
    for (int column = 0; column < camera.width(); ++column) {
      for (const auto& offset : pattern) {
        horizontal_.push_back(
            (world_from_camera.rotation * camera.Bearing({column + offset[0], camera.cy()}))
                .cast<float>());
      }
    }
    for (int row = 0; row < camera.height(); ++row) {
      for (const auto& offset : pattern) {
        const Eigen::Vector3d bearing = camera.Bearing({camera.cx(), row + offset[1]});
        latitude_.emplace_back(static_cast<float>(-bearing.x()), static_cast<float>(bearing.z()));
      }
    }
  }
  Vector3f At(int column, int row, int sample) const {
    const Vector2f& latitude =
        latitude_[static_cast<size_t>(row) * pattern_size_ + static_cast<size_t>(sample)];
    return latitude.x() * horizontal_[static_cast<size_t>(column) * pattern_size_ +
                                      static_cast<size_t>(sample)] +
           latitude.y() * up_;
  }

 private:
  size_t pattern_size_;
  std::vector<Vector3f> horizontal_;
  std::vector<Vector2f> latitude_;  // cosine, sine
  Vector3f up_;
};

void SetRay(RTCRay16& rays, int lane, const Vector3f& origin, const Vector3f& direction,
            float far) {
  rays.org_x[lane] = origin.x();
  rays.org_y[lane] = origin.y();
  rays.org_z[lane] = origin.z();
  rays.dir_x[lane] = direction.x();
  rays.dir_y[lane] = direction.y();
  rays.dir_z[lane] = direction.z();
  rays.tnear[lane] = 0;
  rays.tfar[lane] = far;
  rays.time[lane] = 0;
  rays.mask[lane] = ~0U;
  rays.id[lane] = 0;
  rays.flags[lane] = 0;
}

void ClearHit(RTCHit16& hit, int lane) {
  hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

/// Traces and shades the packet of four pixels that starts at (column, row).
class PacketRenderer {
 public:
  PacketRenderer(const RayScene& scene, const Shader& shader, const RayDirections& directions,
                 const Vector3f& origin, float sample_angle)
      : scene_(&scene),
        shader_(&shader),
        directions_(&directions),
        origin_(origin),
        sample_angle_(sample_angle) {
    const Vector3f& to_sun = shader.light().to_sun;
    sun_x_ = to_sun.unitOrthogonal();
    sun_y_ = to_sun.cross(sun_x_);
    has_sun_ = shader.light().sun.maxCoeff() > 0;
  }

  void Render(int column, int row, std::array<Vector3f, kPixels>* result) {
    for (int lane = 0; lane < kPacket; ++lane) {
      SetRay(rays_.ray, lane, origin_,
             directions_->At(column + lane / kSamples, row, lane % kSamples), kFar);
      ClearHit(rays_.hit, lane);
      valid_[static_cast<size_t>(lane)] = -1;
    }
    scene_->Intersect(valid_.data(), &rays_);
    bool any_shadow_ray = false;
    for (int lane = 0; lane < kPacket; ++lane) any_shadow_ray |= EvaluateLane(column, row, lane);
    if (any_shadow_ray) scene_->Occluded(valid_.data(), &shadows_);
    result->fill(Vector3f::Zero());
    for (int lane = 0; lane < kPacket; ++lane) {
      (*result)[static_cast<size_t>(lane / kSamples)] +=
          Radiance(lane).cwiseMin(kMaximumRadiance) * (1.0F / kSamples);
    }
  }

 private:
  Vector3f Direction(int lane) const {
    return {rays_.ray.dir_x[lane], rays_.ray.dir_y[lane], rays_.ray.dir_z[lane]};
  }
  bool Missed(int lane) const { return rays_.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID; }

  /// Finds the lane's surface and sets up its ray to the sun; false if it needs none.
  bool EvaluateLane(int column, int row, int lane) {
    const auto index = static_cast<size_t>(lane);
    valid_[index] = 0;
    if (Missed(lane)) return false;
    const Vector3f direction = Direction(lane);
    const float range = rays_.ray.tfar[lane];
    const SurfaceHit hit = scene_->Resolve(rays_.hit, lane);
    surfaces_[index] = shader_->Evaluate(hit, rays_.hit.u[lane], rays_.hit.v[lane], direction,
                                         range * sample_angle_, kLevelOffset[index % kSamples]);
    if (!has_sun_ || surfaces_[index].sun_cosine <= 0) return false;
    // Just off the surface, on the side the ray came from.
    Vector3f geometric(rays_.hit.Ng_x[lane], rays_.hit.Ng_y[lane], rays_.hit.Ng_z[lane]);
    if (hit.instance != nullptr) geometric = hit.instance->world_from_model.linear() * geometric;
    geometric.normalize();
    if (geometric.dot(direction) > 0) geometric = -geometric;
    constexpr float kOffset = 2e-3F;  // metres; well above the rounding of coordinates
    const Vector3f origin = origin_ + range * direction + (kOffset + 1e-5F * range) * geometric;
    // A point of the sun's disc: one of four rings' sectors, turned by a hash of the pixel.
    const uint64_t bits =
        Hash(static_cast<uint64_t>(row) << 24 | static_cast<uint64_t>(column * kSamples + lane));
    const float angle = 6.2831853F * static_cast<float>(bits & 0xffffU) * 0x1p-16F;
    const float radius =
        kSunRadius * std::sqrt((static_cast<float>(lane % kSamples) +
                                static_cast<float>(bits >> 16 & 0xffffU) * 0x1p-16F) /
                               kSamples);
    const Vector3f to_sun =
        shader_->light().to_sun + radius * (std::cos(angle) * sun_x_ + std::sin(angle) * sun_y_);
    SetRay(shadows_, lane, origin, to_sun, kFar);
    valid_[index] = -1;
    return true;
  }

  Vector3f Radiance(int lane) const {
    const auto index = static_cast<size_t>(lane);
    const Vector3f direction = Direction(lane);
    if (Missed(lane)) return shader_->sky().Radiance(direction);
    const bool sunlit = valid_[index] != 0 && shadows_.tfar[lane] >= 0;
    return shader_->Radiance(surfaces_[index], sunlit, direction, rays_.ray.tfar[lane]);
  }

  const RayScene* scene_;
  const Shader* shader_;
  const RayDirections* directions_;
  Vector3f origin_;
  float sample_angle_;
  Vector3f sun_x_;
  Vector3f sun_y_;
  bool has_sun_;
  RTCRayHit16 rays_;
  RTCRay16 shadows_;
  alignas(64) std::array<int, kPacket> valid_;
  std::array<Surface, kPacket> surfaces_;
};

}  // namespace

cv::Mat3b RenderColour(const RayScene& scene, const Shader& shader,
                       const EquirectangularCamera& camera, const Rigid3& world_from_camera) {
  const RayDirections directions(camera, world_from_camera, {kPattern.begin(), kPattern.end()});
  const Vector3f origin = world_from_camera.translation.cast<float>();
  const auto sample_angle = static_cast<float>(camera.AngleOfPixels(1.0 / std::sqrt(kSamples)));
  const ToneCurve tone;
  cv::Mat3b image(camera.height(), camera.width());
#pragma omp parallel
  {
    PacketRenderer packet(scene, shader, directions, origin, sample_angle);
    std::array<Vector3f, kPixels> colours;
#pragma omp for schedule(dynamic, 2)
    for (int row = 0; row < camera.height(); ++row) {
      for (int column = 0; column < camera.width(); column += kPixels) {
        packet.Render(std::min(column, camera.width() - kPixels), row, &colours);
        for (int i = 0; i < kPixels; ++i) {
          image(row, std::min(column, camera.width() - kPixels) + i) =
              tone.Encode(colours[static_cast<size_t>(i)]);
        }
      }
    }
  }
  return image;
}

cv::Mat1f RenderRange(const RayScene& scene, const EquirectangularCamera& camera,
                      const Rigid3& world_from_camera) {
  const RayDirections directions(camera, world_from_camera, {{0.5, 0.5}});
  const Vector3f origin = world_from_camera.translation.cast<float>();
  cv::Mat1f range(camera.height(), camera.width());
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < camera.height(); ++row) {
    RTCRayHit16 rays;
    alignas(64) std::array<int, kPacket> valid;
    for (int column = 0; column < camera.width(); column += kPacket) {
      for (int lane = 0; lane < kPacket; ++lane) {
        const bool inside = column + lane < camera.width();
        valid[static_cast<size_t>(lane)] = inside ? -1 : 0;
        SetRay(rays.ray, lane, origin, directions.At(inside ? column + lane : column, row, 0),
               kFar);
        ClearHit(rays.hit, lane);
      }
      scene.Intersect(valid.data(), &rays);
      for (int lane = 0; lane < kPacket && column + lane < camera.width(); ++lane) {
        range(row, column + lane) =
            rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID ? 0 : rays.ray.tfar[lane];
      }
    }
  }
  return range;
}

}  // namespace orb360::town
