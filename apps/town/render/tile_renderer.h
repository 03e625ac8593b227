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
/// Positions of the samples in a pixel: a rotated grid, so that edges near the horizontal and the
/// vertical take all four shades.
inline constexpr std::array<std::array<double, 2>, kSamples> kSamplePattern = {
    {{0.125, 0.375}, {0.375, 0.875}, {0.625, 0.125}, {0.875, 0.625}}};

/// The samples, of the four of a pixel, for which rays are traced to the surface and from there to
/// the sun.
enum class Sampling {
  /// One sample is traced. All four are traced where this sample and those of the neighbouring
  /// pixels meet different surfaces, or where some of them see the sun and others do not. Elsewhere
  /// they lie on one plane, so that the positions of the others can be computed; only details
  /// smaller than a pixel are lost.
  kAdaptive,
  kFull,  ///< for all
};

/// Renders an image tile by tile.
class TileRenderer {
 public:
  /// Size of a tile, pixels. With the samples around it, it is a whole number of packets.
  static constexpr int kWidth = 63;
  static constexpr int kHeight = 30;

  /// `directions` are those of kSamplePattern; `sample_angle` is the width of one sample, in
  /// radians.
  TileRenderer(const FrameScene& scene, const Shader& shader, const RayDirections& directions,
               const Vector3f& eye, float sample_angle, Sampling sampling);

  /// Renders the pixels of a rectangle of at most kWidth x kHeight. The result depends on the
  /// rectangle only.
  void Render(const cv::Rect& tile);
  /// Returns the radiance of a pixel of the image that lies in the last tile.
  const Vector3f& At(int column, int row) const { return pixels_[IndexOf(column, row)]; }

 private:
  static constexpr size_t kStride = kWidth + 1;
  static constexpr size_t kPixels = kStride * (kHeight + 2);
  static constexpr int kSide = RayDirections::kSquare;

  /// One number for each pixel of the tile, of the column to its right and of the rows above and
  /// below, indexed by IndexOf.
  using Plane = std::array<float, kPixels>;
  /// The data of the first sample of a pixel.
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
  /// Returns the point of the sun's disc at which a sample looks. The points are permuted from
  /// pixel to pixel, so that the first samples of neighbours together reveal whether a part of the
  /// disc is hidden.
  const Vector3f& ToSun(int column, int row, size_t sample) const {
    return to_sun_[(sample + static_cast<size_t>(column + 2 * row + 2)) % kSamples];
  }
  /// Traces a ray to a point of the sun, `sun_of(lane)`, from each visible surface.
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
