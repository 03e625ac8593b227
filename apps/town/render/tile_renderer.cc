#include "apps/town/render/tile_renderer.h"

#include <algorithm>
#include <cmath>

namespace orb360::town {
namespace {

constexpr float kSunRadius = 0.0047F;  // radians
/// Offsets distributed over a mip level, so that the mean of a pixel's samples is filtered
/// trilinearly.
constexpr std::array<float, kSamples> kLevelOffset = {0.125F, 0.625F, 0.875F, 0.375F};
constexpr size_t kBatch = kPacket / kSamples;  // pixels whose samples fill a packet

}  // namespace

TileRenderer::TileRenderer(const FrameScene& scene, const Shader& shader,
                           const RayDirections& directions, const Vector3f& eye, float sample_angle,
                           Sampling sampling)
    : scene_(&scene),
      shader_(&shader),
      directions_(&directions),
      eye_(eye),
      sample_angle_(sample_angle),
      sampling_(sampling),
      has_sun_(shader.light().sun.maxCoeff() > 0),
      met_() {
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

void TileRenderer::Render(const cv::Rect& tile) {
  tile_ = tile;
  edges_.clear();
  if (sampling_ == Sampling::kAdaptive) {
    TraceCorners();
    JoinCorners();
  }
  RenderPixels();
  RenderEdges();
}

template <typename SunOf>
void TileRenderer::TraceShadows(const SunOf& sun_of) {
  shadows_.Clear();
  if (!has_sun_) return;
  for (size_t i = 0; i < kPacket; ++i) {
    if (sight_.surface[i] == 0 || sight_.sun_cosine[i] <= 0) continue;
    const Vector3f way = sight_.way.At(i);
    const Vector3f normal = sight_.geometric_normal.At(i);
    // The ray begins slightly before the surface, metres: well above the rounding of coordinates.
    const float lift = 2e-3F + 1e-5F * sight_.range[i];
    const float side = normal.dot(way) > 0 ? -lift : lift;
    shadows_.Set(static_cast<int>(i), eye_ + way + side * normal, sun_of(i));
  }
  shadows_.Trace(*scene_);
}

void TileRenderer::TraceCorners() {
  for (size_t k = 0; k < kSamples; ++k) samples_[k].level_offset.fill(kLevelOffset[k]);
  for (int top = tile_.y - 1; top <= tile_.y + tile_.height; top += kSide) {
    for (int left = tile_.x; left <= tile_.x + tile_.width; left += kSide) {
      for (size_t k = 0; k < kSamples; ++k)
        directions_->OfSquare(left, top, k, &samples_[k].direction);
      eye_rays_.Trace(*scene_, eye_, samples_[0].direction);
      shader_->Shade(*scene_, eye_rays_, samples_, sample_angle_, &met_, &sight_);
      TraceShadows([&](size_t i) -> const Vector3f& {
        const int lane = static_cast<int>(i);
        return ToSun(left + lane % kSide, top + lane / kSide, 0);
      });
      KeepCorners(left, top);
    }
  }
}

void TileRenderer::KeepCorners(int left, int top) {
  const size_t first = IndexOf(left, top);
  for (size_t row = 0; row < kSide; ++row) {
    const size_t from = row * kSide;
    const size_t to = first + row * kStride;
    const auto keep = [&](const auto& lanes, auto* plane) {
      std::copy_n(lanes.begin() + from, kSide, plane->begin() + to);
    };
    const auto keep3 = [&](const Lanes3& lanes, std::array<Plane, 3>* planes) {
      keep(lanes.x, &(*planes)[0]);
      keep(lanes.y, &(*planes)[1]);
      keep(lanes.z, &(*planes)[2]);
    };
    keep(sight_.surface, &corners_.surface);
    keep(sight_.range, &corners_.range);
    keep3(sight_.way, &corners_.way);
    keep3(sight_.geometric_normal, &corners_.normal);
    keep3(sight_.shade, &corners_.shade);
    keep3(sight_.sun, &corners_.sun);
    for (size_t column = 0; column < kSide; ++column)
      corners_.sunlit[to + column] = shadows_.IsLit(static_cast<int>(from + column)) ? 1 : 0;
  }
}

void TileRenderer::JoinCorners() {
  constexpr float kCosine = 0.99F;  // of 8 degrees
  const Corners& c = corners_;
  const float step = 0.5F * sample_angle_;  // a quarter of a pixel
  // Returns true if neighbours show one material of one object, their normals differ by at most 8
  // degrees, and one lies on the other's plane. A step of a quarter of a pixel, or 5 mm, is the
  // curvature that those normals allow.
  const auto join = [&](size_t a, size_t b) -> uint8_t {
    const float alike = c.normal[0][a] * c.normal[0][b] + c.normal[1][a] * c.normal[1][b] +
                        c.normal[2][a] * c.normal[2][b];
    const float off_plane = c.normal[0][a] * (c.way[0][b] - c.way[0][a]) +
                            c.normal[1][a] * (c.way[1][b] - c.way[1][a]) +
                            c.normal[2][a] * (c.way[2][b] - c.way[2][a]);
    // Integers, combined without a branch, so that the loops below are vectorized.
    const int is_parallel = alike > kCosine;
    const int is_near = std::abs(off_plane) < 5e-3F + step * c.range[a];
    const int is_one_surface = c.surface[a] == c.surface[b];
    const int is_sky = c.surface[a] == 0;
    return static_cast<uint8_t>(is_one_surface & ((is_parallel & is_near) | is_sky));
  };
  const auto used = static_cast<size_t>(tile_.height + 2) * kStride;
  for (size_t i = 0; i + 1 < used; ++i) corners_.joins_right[i] = join(i, i + 1);
  for (size_t i = 0; i + kStride < used; ++i) corners_.joins_below[i] = join(i, i + kStride);
}

void TileRenderer::RenderPixels() {
  // Pixels are grouped by small squares, so that the rays of a packet at edges stay together.
  const int bottom = tile_.y + tile_.height;
  const int right = tile_.x + tile_.width;
  for (int top = tile_.y; top < bottom; top += kSide) {
    for (int left = tile_.x; left < right; left += kSide) {
      for (int row = top; row < std::min(top + kSide, bottom); ++row) {
        for (int column = left; column < std::min(left + kSide, right); ++column) {
          if (sampling_ == Sampling::kFull) {
            edges_.emplace_back(column, row);
            continue;
          }
          // The six first samples around the further ones, including those of the rows above and
          // below.
          const Corners& c = corners_;
          const size_t here = IndexOf(column, row);
          const size_t above = here - kStride;
          const size_t below = here + kStride;
          const bool is_flat = (c.joins_right[above] & c.joins_below[above] & c.joins_right[here] &
                                c.joins_below[here] & c.joins_right[below]) != 0;
          const float sunlit = c.sunlit[above] + c.sunlit[above + 1] + c.sunlit[here] +
                               c.sunlit[here + 1] + c.sunlit[below] + c.sunlit[below + 1];
          if (!is_flat || (sunlit > 0 && sunlit < 6)) {
            edges_.emplace_back(column, row);
            continue;
          }
          const Vector3f shade(c.shade[0][here], c.shade[1][here], c.shade[2][here]);
          const Vector3f sun(c.sun[0][here], c.sun[1][here], c.sun[2][here]);
          pixels_[here] = (shade + c.sunlit[here] * sun).cwiseMin(kMaximumRadiance);
        }
      }
    }
  }
}

void TileRenderer::RenderEdges() {
  SampleLanes& sample = samples_[0];
  for (size_t i = 0; i < kPacket; ++i) sample.level_offset[i] = kLevelOffset[i % kSamples];
  for (size_t first = 0; first < edges_.size(); first += kBatch) {
    const size_t count = std::min(kBatch, edges_.size() - first);
    // The last batch repeats its last pixel.
    const auto pixel_of = [&](size_t lane) -> const cv::Point& {
      return edges_[first + std::min(lane / kSamples, count - 1)];
    };
    for (size_t i = 0; i < kPacket; ++i) {
      const cv::Point& pixel = pixel_of(i);
      sample.direction.Set(i, directions_->At(pixel.x, pixel.y, i % kSamples));
    }
    eye_rays_.Trace(*scene_, eye_, sample.direction);
    shader_->Shade(*scene_, eye_rays_, {&sample, 1}, sample_angle_, &met_, &sight_);
    TraceShadows([&](size_t i) -> const Vector3f& {
      return ToSun(pixel_of(i).x, pixel_of(i).y, i % kSamples);
    });
    for (size_t k = 0; k < count; ++k) {
      Vector3f sum = Vector3f::Zero();
      for (size_t i = k * kSamples; i < (k + 1) * kSamples; ++i) {
        const float sunlit = shadows_.IsLit(static_cast<int>(i)) ? 1 : 0;
        const Vector3f radiance = sight_.shade.At(i) + sunlit * sight_.sun.At(i);
        sum += radiance.cwiseMin(kMaximumRadiance);
      }
      pixels_[IndexOf(edges_[first + k].x, edges_[first + k].y)] = sum / kSamples;
    }
  }
}

}  // namespace orb360::town
