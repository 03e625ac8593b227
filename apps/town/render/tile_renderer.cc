#include "apps/town/render/tile_renderer.h"

#include <algorithm>
#include <cmath>

namespace orb360::town {
namespace {

constexpr float kSunRadius = 0.0047F;     // radians
constexpr float kMaximumRadiance = 5.0F;  // keeps one bright sample from outshining a pixel
/// Spread over a mip level, so that the mean of a pixel's samples is filtered trilinearly.
constexpr std::array<float, kSamples> kLevelOffset = {0.125F, 0.625F, 0.875F, 0.375F};
constexpr size_t kFurther = kSamples - 1;      // samples of a pixel besides the first
constexpr size_t kBatch = kPacket / kFurther;  // pixels whose further samples fill a packet

}  // namespace

/// A pixel that one plane fills: its four samples there.
struct TileRenderer::FlatPixel {
  std::array<Vector3f, kSamples> ways;  // from the eye
  Vector3f colours = Vector3f::Zero();  // sum
};

/// A pixel in which surfaces meet.
struct TileRenderer::EdgePixel {
  /// The part that one surface fills.
  struct Patch {
    Spot spot;
    Vector3f colours = Vector3f::Zero();  // sum
    int samples = 0;
    int sunlit = 0;
  };
  static constexpr size_t kSky = kSamples;

  std::array<Patch, kSamples> patches;
  size_t patch_count = 0;
  std::array<size_t, kSamples> patch_of = {kSky, kSky, kSky, kSky};
  Vector3f sky = Vector3f::Zero();  // sum
};

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
      spots_(kStride * (kHeight + 2)),
      corners_(spots_.size()),
      pixels_(spots_.size()) {
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
  penumbras_.clear();
  TraceCorners();
  // By small squares, so that the rays of a packet of edges keep together.
  constexpr int kSide = 4;
  for (int top = tile.y; top < tile.y + tile.height; top += kSide) {
    for (int left = tile.x; left < tile.x + tile.width; left += kSide) {
      for (int row = top; row < std::min(top + kSide, tile.y + tile.height); ++row) {
        for (int column = left; column < std::min(left + kSide, tile.x + tile.width); ++column)
          RenderPixel(column, row);
      }
    }
  }
  RenderPenumbras();
  RenderEdges();
}

Surface TileRenderer::Describe(const Sighting& seen) const {
  return shader_->Describe(seen.hit, seen.b, seen.c, seen.direction, seen.range * sample_angle_);
}

Vector3f TileRenderer::SkySample(const Vector3f& direction) const {
  return shader_->sky().Radiance(direction).cwiseMin(kMaximumRadiance);
}

Vector3f TileRenderer::Shade(const Spot& spot, const Vector3f& colours, int samples,
                             int sunlit) const {
  const auto number = static_cast<float>(samples);
  const Vector3f radiance =
      shader_->Radiance(spot.surface, colours / number, static_cast<float>(sunlit) / number,
                        spot.seen.direction, spot.seen.range);
  return number * radiance.cwiseMin(kMaximumRadiance);
}

void TileRenderer::TraceCorners() {
  constexpr int kSide = 4;  // of the square of pixels whose first samples are a packet
  const int right = tile_.x + tile_.width;
  const int bottom = tile_.y + tile_.height;
  for (int top = tile_.y - 1; top <= bottom; top += kSide) {
    for (int left = tile_.x; left <= right; left += kSide) {
      std::array<SamplePlace, kPacket> places;
      size_t count = 0;
      for (int y = top; y <= std::min(top + kSide - 1, bottom); ++y) {
        for (int x = left; x <= std::min(left + kSide - 1, right); ++x) places[count++] = {x, y, 0};
      }
      eye_rays_.Trace(*scene_, *directions_, eye_, {places.data(), count});
      shadows_.Clear();
      for (size_t i = 0; i < count; ++i) {
        Spot& spot = spots_[IndexOf(places[i].column, places[i].row)];
        spot.seen = See(*scene_, eye_rays_, static_cast<int>(i));
        if (spot.seen.IsSky()) continue;
        spot.surface = Describe(spot.seen);
        if (FacesSun(spot.surface))
          shadows_.Set(static_cast<int>(i), eye_ + LiftedWay(spot.seen, spot.seen.Way()),
                       ToSun(places[i]));
      }
      shadows_.Trace(*scene_);
      for (size_t i = 0; i < count; ++i)
        corners_[IndexOf(places[i].column, places[i].row)].sunlit =
            shadows_.IsLit(static_cast<int>(i));
    }
  }
  if (sampling_ == Sampling::kFull) return;
  for (int row = tile_.y - 1; row <= bottom; ++row) {
    for (int column = tile_.x; column <= right; ++column) {
      const size_t index = IndexOf(column, row);
      const Sighting& seen = spots_[index].seen;
      corners_[index].joins_right =
          column < right && Join(seen, spots_[index + 1].seen, 2 * sample_angle_);
      corners_[index].joins_below =
          row < bottom && Join(seen, spots_[index + kStride].seen, 2 * sample_angle_);
    }
  }
}

void TileRenderer::RenderPixel(int column, int row) {
  // The six first samples around the further ones: those of the rows above and below as well.
  const size_t index = IndexOf(column, row);
  const Corner* above = &corners_[index - kStride];
  const Corner* here = &corners_[index];
  const Corner* below = &corners_[index + kStride];
  const bool is_edge = sampling_ == Sampling::kFull || !above->joins_right || !above->joins_below ||
                       !here->joins_right || !here->joins_below || !below->joins_right;
  if (is_edge) {
    edges_.emplace_back(column, row);
    return;
  }
  Vector3f sum = Vector3f::Zero();
  if (spots_[index].seen.IsSky()) {
    for (size_t i = 0; i < kSamples; ++i) sum += SkySample(directions_->At(column, row, i));
  } else {
    const int sunlit = above[0].sunlit + above[1].sunlit + here[0].sunlit + here[1].sunlit +
                       below[0].sunlit + below[1].sunlit;
    if (sunlit != 0 && sunlit != 6) {
      penumbras_.emplace_back(column, row);
      return;
    }
    sum = Shade(spots_[index], PlaceOnPlane(column, row).colours, kSamples,
                sunlit == 0 ? 0 : kSamples);
  }
  pixels_[index] = sum * (1.0F / kSamples);
}

TileRenderer::FlatPixel TileRenderer::PlaceOnPlane(int column, int row) const {
  const auto& [seen, surface] = spots_[IndexOf(column, row)];
  FlatPixel flat;
  const TextureMapping mapping = MapTexture(seen.hit, seen.b, seen.c);
  flat.ways[0] = seen.Way();
  flat.colours = Shader::Colour(surface, mapping.here, kLevelOffset[0]);
  const float height = seen.normal.dot(flat.ways[0]);
  for (size_t i = 1; i < kSamples; ++i) {
    const Vector3f direction = directions_->At(column, row, i);
    const float range = height / seen.normal.dot(direction);
    // A curved surface's plane may be met elsewhere, or nowhere.
    const bool is_near = range > 0.5F * seen.range && range < 2 * seen.range;
    flat.ways[i] = (is_near ? range : seen.range) * direction;
    flat.colours +=
        Shader::Colour(surface, mapping.At(flat.ways[i] - flat.ways[0]), kLevelOffset[i]);
  }
  return flat;
}

void TileRenderer::RenderPenumbras() {
  for (size_t first = 0; first < penumbras_.size(); first += kBatch) {
    const size_t count = std::min(kBatch, penumbras_.size() - first);
    std::array<FlatPixel, kBatch> flats;
    shadows_.Clear();
    for (size_t k = 0; k < count; ++k) {
      const cv::Point& place = penumbras_[first + k];
      const Spot& spot = spots_[IndexOf(place.x, place.y)];
      flats[k] = PlaceOnPlane(place.x, place.y);
      for (size_t i = 1; i < kSamples && FacesSun(spot.surface); ++i) {
        shadows_.Set(static_cast<int>(k * kFurther + i - 1),
                     eye_ + LiftedWay(spot.seen, flats[k].ways[i]), ToSun({place.x, place.y, i}));
      }
    }
    shadows_.Trace(*scene_);
    for (size_t k = 0; k < count; ++k) {
      const size_t index = IndexOf(penumbras_[first + k].x, penumbras_[first + k].y);
      int sunlit = corners_[index].sunlit ? 1 : 0;
      for (size_t i = 0; i < kFurther; ++i)
        sunlit += shadows_.IsLit(static_cast<int>(k * kFurther + i)) ? 1 : 0;
      pixels_[index] = Shade(spots_[index], flats[k].colours, kSamples, sunlit) * (1.0F / kSamples);
    }
  }
}

void TileRenderer::RenderEdges() {
  for (size_t first = 0; first < edges_.size(); first += kBatch) {
    const size_t count = std::min(kBatch, edges_.size() - first);
    std::array<SamplePlace, kPacket> places;
    for (size_t k = 0; k < count; ++k) {
      for (size_t i = 0; i < kFurther; ++i)
        places[k * kFurther + i] = {edges_[first + k].x, edges_[first + k].y, i + 1};
    }
    eye_rays_.Trace(*scene_, *directions_, eye_, {places.data(), count * kFurther});
    shadows_.Clear();
    std::array<EdgePixel, kBatch> pixels;
    for (size_t k = 0; k < count; ++k) {
      EdgePixel& pixel = pixels[k];
      const Spot& spot = spots_[IndexOf(edges_[first + k].x, edges_[first + k].y)];
      for (size_t i = 0; i < kSamples; ++i) {
        const int lane = static_cast<int>(k * kFurther + i) - 1;  // of the further samples
        const Sighting seen = i == 0 ? spot.seen : See(*scene_, eye_rays_, lane);
        if (seen.IsSky()) {
          pixel.sky += SkySample(seen.direction);
          continue;
        }
        size_t p = 0;
        while (p < pixel.patch_count && !SharePlane(pixel.patches[p].spot.seen, seen)) ++p;
        EdgePixel::Patch& patch = pixel.patches[p];
        if (p == pixel.patch_count) {
          patch.spot = i == 0 ? spot : Spot{seen, Describe(seen)};
          ++pixel.patch_count;
        }
        pixel.patch_of[i] = p;
        ++patch.samples;
        patch.colours += Shader::Colour(
            patch.spot.surface, TextureCoordinates(seen.hit, seen.b, seen.c), kLevelOffset[i]);
        if (i > 0 && FacesSun(patch.spot.surface))
          shadows_.Set(lane, eye_ + LiftedWay(patch.spot.seen, seen.Way()),
                       ToSun(places[static_cast<size_t>(lane)]));
      }
    }
    shadows_.Trace(*scene_);
    for (size_t k = 0; k < count; ++k) {
      EdgePixel& pixel = pixels[k];
      const size_t index = IndexOf(edges_[first + k].x, edges_[first + k].y);
      for (size_t i = 0; i < kSamples; ++i) {
        if (pixel.patch_of[i] == EdgePixel::kSky) continue;
        const bool is_lit = i == 0 ? corners_[index].sunlit
                                   : shadows_.IsLit(static_cast<int>(k * kFurther + i) - 1);
        pixel.patches[pixel.patch_of[i]].sunlit += is_lit ? 1 : 0;
      }
      Vector3f sum = pixel.sky;
      for (size_t p = 0; p < pixel.patch_count; ++p) {
        const EdgePixel::Patch& patch = pixel.patches[p];
        sum += Shade(patch.spot, patch.colours, patch.samples, patch.sunlit);
      }
      pixels_[index] = sum * (1.0F / kSamples);
    }
  }
}

}  // namespace orb360::town
