#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "apps/town/render/ray_directions.h"
#include "apps/town/render/ray_packet.h"
#include "apps/town/render/ray_scene.h"
#include "apps/town/render/shading.h"

namespace orb360::town {

inline constexpr size_t kSamples = 4;  ///< of a pixel
/// Positions of the samples in a pixel: a rotated grid, so that edges near the horizontal and
/// the vertical take all four shades.
inline constexpr std::array<std::array<double, 2>, kSamples> kSamplePattern = {
    {{0.125, 0.375}, {0.375, 0.875}, {0.625, 0.125}, {0.875, 0.625}}};

/// For which of a pixel's four samples rays are traced, to the surface and from there to the sun.
enum class Sampling {
  /// For one; for all where this one and those of the pixels around meet different surfaces, or
  /// some of them the sun and others not. Elsewhere they lie on one plane, so that the others can
  /// be placed by calculation: nothing is lost but what is smaller than a pixel.
  kAdaptive,
  kFull,  ///< for all
};

/// Renders a picture piece by piece.
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
  static constexpr size_t kStride = kWidth + 1;
  static constexpr size_t kPixels = kStride * (kHeight + 2);
  static constexpr int kSide = RayDirections::kSquare;

  /// A number of each pixel of the tile, of the column to its right and of the rows above and
  /// below, by IndexOf.
  using Plane = std::array<float, kPixels>;
  /// What the first sample of a pixel tells.
  struct Corners {
    std::array<uint32_t, kPixels> surface;
    Plane range;
    std::array<Plane, 3> way;
    std::array<Plane, 3> normal;
    std::array<Plane, 3> shade;  // mean over the samples, if all of them lie on its plane
    std::array<Plane, 3> sun;
    Plane sunlit;                              // 1 or 0
    std::array<uint8_t, kPixels> joins_right;  // one plane fills the way to the next first sample
    std::array<uint8_t, kPixels> joins_below;
  };

  size_t IndexOf(int column, int row) const {
    return static_cast<size_t>(row - tile_.y + 1) * kStride + static_cast<size_t>(column - tile_.x);
  }
  /// The point of the sun's disc that a sample looks at: each pixel's samples take turns, so that
  /// the first samples of neighbours together see whether a part of the disc is hidden.
  const Vector3f& ToSun(int column, int row, size_t sample) const {
    return to_sun_[(sample + static_cast<size_t>(column + 2 * row + 2)) % kSamples];
  }
  /// Traces a ray to a point of the sun, `sun_of(lane)`, from each surface that is seen.
  template <typename SunOf>
  void TraceShadows(const SunOf& sun_of);
  void TraceCorners();
  void KeepCorners(int left, int top);
  void JoinCorners();
  void RenderPixels();
  void RenderEdges();

  const FrameScene* scene_;
  const Shader* shader_;
  const RayDirections* directions_;
  Vector3f eye_;
  float sample_angle_;
  Sampling sampling_;
  bool has_sun_;
  std::array<Vector3f, kSamples> to_sun_;

  cv::Rect tile_;
  Corners corners_;
  std::array<Vector3f, kPixels> pixels_;  // by IndexOf
  std::vector<cv::Point> edges_;          // pixels that need all rays
  EyePacket eye_rays_;
  ShadowPacket shadows_;
  std::array<SampleLanes, kSamples> samples_;
  SurfaceLanes met_;
  SightLanes sight_;
};

}  // namespace orb360::town
