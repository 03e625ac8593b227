#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "apps/town/render/ray_directions.h"
#include "apps/town/render/ray_packet.h"
#include "apps/town/render/ray_scene.h"
#include "apps/town/render/shading.h"
#include "apps/town/render/sighting.h"

namespace orb360::town {

inline constexpr size_t kSamples = 4;  ///< of a pixel
/// Positions of the samples in a pixel: a rotated grid, so that edges near the horizontal and
/// the vertical take all four shades.
inline constexpr std::array<std::array<double, 2>, kSamples> kSamplePattern = {
    {{0.125, 0.375}, {0.375, 0.875}, {0.625, 0.125}, {0.875, 0.625}}};

/// For which of a pixel's four samples rays are traced, to the surface and from there to the sun.
enum class Sampling {
  /// For one; for the others where this one and those of the pixels around meet different surfaces.
  /// Elsewhere they lie on one plane, so that the others can be placed by calculation: nothing is
  /// lost but what is smaller than a pixel. Rays to the sun are saved in the same way.
  kAdaptive,
  kFull,  ///< for all
};

/// Renders a picture piece by piece. Samples of a pixel that meet the same surface share its
/// description and its lighting; each has its own texture sample and its own point on the sun.
class TileRenderer {
 public:
  /// Pixels of a tile, so that with the samples around it it is a whole number of packets.
  static constexpr int kWidth = 63;
  static constexpr int kHeight = 30;

  /// `directions` are those of kSamplePattern, `sample_angle` what one sample is wide, in radians.
  TileRenderer(const FrameScene& scene, const Shader& shader, const RayDirections& directions,
               const Vector3f& eye, float sample_angle, Sampling sampling);

  /// Renders the pixels of a rectangle of at most kWidth x kHeight. What it gives depends on the
  /// rectangle alone.
  void Render(const cv::Rect& tile);
  /// Radiance of a pixel of the picture that lies in the last tile.
  const Vector3f& At(int column, int row) const { return pixels_[IndexOf(column, row)]; }

 private:
  struct Spot {
    Sighting seen;
    Surface surface;
  };
  /// What the first sample of a pixel tells.
  struct Corner {
    bool sunlit : 1;
    bool joins_right : 1;  ///< one plane fills the way to the first sample of the next pixel
    bool joins_below : 1;
  };
  struct EdgePixel;
  struct FlatPixel;

  size_t IndexOf(int column, int row) const {
    return static_cast<size_t>(row - tile_.y + 1) * kStride + static_cast<size_t>(column - tile_.x);
  }
  Surface Describe(const Sighting& seen) const;
  bool FacesSun(const Surface& surface) const { return has_sun_ && surface.sun_cosine > 0; }
  /// The point of the sun's disc that a sample looks at: each pixel's samples take turns, so that
  /// the first samples of neighbours together see whether a part of the disc is hidden.
  const Vector3f& ToSun(const SamplePlace& place) const {
    const auto turn = static_cast<size_t>(place.column + 2 * place.row + 2);
    return to_sun_[(place.sample + turn) % kSamples];
  }
  Vector3f SkySample(const Vector3f& direction) const;
  /// The light from a number of samples that meet one surface.
  Vector3f Shade(const Spot& spot, const Vector3f& colours, int samples, int sunlit) const;

  void TraceCorners();
  void RenderPixel(int column, int row);
  FlatPixel PlaceOnPlane(int column, int row) const;
  void RenderPenumbras();
  void RenderEdges();

  static constexpr size_t kStride = kWidth + 1;

  const FrameScene* scene_;
  const Shader* shader_;
  const RayDirections* directions_;
  Vector3f eye_;
  float sample_angle_;
  Sampling sampling_;
  bool has_sun_;
  std::array<Vector3f, kSamples> to_sun_;

  cv::Rect tile_;
  std::vector<Spot> spots_;           // of the first samples, by IndexOf
  std::vector<Corner> corners_;       // likewise
  std::vector<Vector3f> pixels_;      // likewise
  std::vector<cv::Point> edges_;      // pixels that need all rays
  std::vector<cv::Point> penumbras_;  // pixels on a plane that need more rays to the sun
  EyePacket eye_rays_;
  ShadowPacket shadows_;
};

}  // namespace orb360::town
