#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace orb360 {

/// Where an image of a lens shows a direction.
struct StitchSample {
  /// Index of the image.
  int image = 0;
  /// Pixel, with the centre of the top-left pixel at (0.5, 0.5).
  double x = 0.0;
  double y = 0.0;
  /// Weight against the other sample of the same direction, at least 0.
  double weight = 0.0;
};

/// Gives the samples of a unit bearing in the camera frame (-X forward, +Y right, +Z up), at most
/// two; none where no image shows it. The vector is empty when it is called.
using StitchSampler = std::function<void(const Eigen::Vector3d&, std::vector<StitchSample>*)>;

/// Columns of a sphere, and rows of all images together, that are stitched: 16 bits address them.
inline constexpr int kMaxStitchedSide = 32000;

/// Makes full spheres from the images of lenses by maps that are computed once.
class SphereStitcher {
 public:
  /// `sphere`: size of the result; `images`: sizes of the images. Both are at most
  /// kMaxStitchedSide.
  SphereStitcher(cv::Size sphere, std::vector<cv::Size> images, const StitchSampler& sampler);

  /// Returns the full sphere, CV_8UC3, of images of the sizes given before, CV_8UC3: black where no
  /// image shows anything. `matches_exposure`: the colours of the first two images are brought to
  /// the mean of both, so that they agree where both show the same directions.
  cv::Mat Stitch(std::span<const cv::Mat> images, bool matches_exposure) const;

  cv::Size sphere() const { return sphere_; }

  /// Mask of the sphere, CV_8U: 255 where an image shows something; empty where all do.
  const cv::Mat& coverage() const { return coverage_; }

 private:
  cv::Size sphere_;
  std::vector<cv::Size> sizes_;
  // The images lie one below the other. For each pixel of the sphere: the sample of the larger
  // weight as cv::convertMaps makes it, and its image.
  cv::Mat map_;
  cv::Mat map_fraction_;
  cv::Mat image_;  // CV_8U
  // Pixels with a second sample, kOverlapColumns in a row: their index in the sphere, the sample,
  // its weight in 256ths, and its image.
  std::vector<int> overlap_;
  cv::Mat overlap_map_;
  cv::Mat overlap_fraction_;
  std::vector<int> overlap_weight_;
  std::vector<std::uint8_t> overlap_image_;
  cv::Mat coverage_;
};

}  // namespace orb360
