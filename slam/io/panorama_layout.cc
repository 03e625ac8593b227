#include "slam/io/panorama_layout.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "slam/io/full_sphere.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// Columns on either side of the seam that interpolation can reach.
constexpr int kSeamColumns = 2;

/// Largest side of a padded sphere, pixels: twice that of the largest panoramas of cameras.
/// cv::remap has no more than 16 bits for it.
constexpr int kMaxSide = 32000;

cv::Rect EyeOf(cv::Size stored, const PanoramaMetadata& metadata) {
  cv::Rect eye({}, stored);
  const int second = metadata.is_left_first ? 0 : 1;
  if (metadata.stereo == StereoMode::kTopBottom) {
    eye.height /= 2;
    eye.y = second * eye.height;
  } else if (metadata.stereo == StereoMode::kLeftRight) {
    eye.width /= 2;
    eye.x = second * eye.width;
  }
  return eye;
}

/// Rotation by yaw, pitch and roll in the camera frame: -X forward, +Y right, +Z up.
Eigen::Matrix3d Turn(const PanoramaMetadata& metadata) {
  constexpr double kRadian = std::numbers::pi / 180.0;
  const auto about = [](double degrees, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(degrees * kRadian, axis);
  };
  // Forward to the right: -X to +Y. Forward upwards: -X to +Z. Up to the right: +Z to +Y.
  return (about(-metadata.yaw, Eigen::Vector3d::UnitZ()) *
          about(metadata.pitch, Eigen::Vector3d::UnitY()) *
          about(-metadata.roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// The full sphere of which the eye is a part, in stored pixels, and the eye's place in it.
void PlaceEye(const PanoramaMetadata::Crop& crop, PanoramaLayout* layout) {
  const double width = layout->eye.width / (1.0 - crop.left - crop.right);
  const double height = layout->eye.height / (1.0 - crop.top - crop.bottom);
  layout->sphere = {static_cast<int>(std::lround(width)), static_cast<int>(std::lround(height))};
  layout->place = {{static_cast<int>(std::lround(crop.left * width)),
                    static_cast<int>(std::lround(crop.top * height))},
                   layout->eye.size()};
  layout->place.x = std::min(layout->place.x, layout->sphere.width - layout->place.width);
  layout->place.y = std::min(layout->place.y, layout->sphere.height - layout->place.height);
}

bool IsPossible(const PanoramaMetadata::Crop& crop) {
  // Less than a tenth of a side is of no use, and the padded sphere would need much memory.
  constexpr double kMaxMissing = 0.9;
  const auto is_possible = [](double a, double b) {
    return a >= 0.0 && b >= 0.0 && a + b <= kMaxMissing;
  };
  return is_possible(crop.left, crop.right) && is_possible(crop.top, crop.bottom);
}

/// The size of the sphere with square pixels, or nullopt if it is not twice as wide as high. An
/// image that is a full sphere as stored is left as it is. Eyes of a stereo image that is called
/// equirectangular may be squeezed to half of their size in the direction in which both lie.
std::optional<cv::Size> ShownSize(cv::Size sphere, double sample_aspect,
                                  const PanoramaMetadata& metadata) {
  if (IsFullSphere(sphere)) return sphere;
  const cv::Size shown(static_cast<int>(std::lround(sphere.width * sample_aspect)), sphere.height);
  if (IsFullSphere(shown)) return shown;
  const StereoMode stereo = metadata.is_equirectangular ? metadata.stereo : StereoMode::kMono;
  if (stereo == StereoMode::kTopBottom && IsFullSphere({shown.width, 2 * shown.height})) {
    return cv::Size(shown.width, 2 * shown.height);
  }
  if (stereo == StereoMode::kLeftRight && IsFullSphere({2 * shown.width, shown.height})) {
    return cv::Size(2 * shown.width, shown.height);
  }
  return std::nullopt;
}

}  // namespace

PanoramaLayout MakePanoramaLayout(const std::string& name, cv::Size stored, double sample_aspect,
                                  const PanoramaMetadata& metadata) {
  PanoramaLayout layout;
  layout.eye = EyeOf(stored, metadata);
  if (layout.eye.empty()) throw UserError(name + ": an image of " + ToString(stored) + " is empty");
  layout.sphere = layout.eye.size();
  layout.place = {{}, layout.sphere};
  if (metadata.crop) {
    if (!IsPossible(*metadata.crop)) {
      throw UserError(name +
                      ": its metadata says that more than nine tenths of the sphere's width or "
                      "height are missing; correct or remove it with a metadata tool");
    }
    PlaceEye(*metadata.crop, &layout);
    if (std::max(layout.sphere.width, layout.sphere.height) > kMaxSide) {
      throw UserError(name + ": its metadata makes it part of a full sphere of " +
                      ToString(layout.sphere) +
                      ", which is too large; correct or remove it with a metadata tool");
    }
  }
  const std::optional<cv::Size> shown = ShownSize(layout.sphere, sample_aspect, metadata);
  if (!shown) {
    const cv::Size size(static_cast<int>(std::lround(layout.sphere.width * sample_aspect)),
                        layout.sphere.height);
    if (!metadata.is_equirectangular && metadata.stereo == StereoMode::kMono) {
      RequireFullSphere(name, size);
    }
    throw UserError(name + ": its metadata makes " +
                    (metadata.stereo == StereoMode::kMono ? "it" : "the image of one eye") +
                    " part of a full sphere of " + ToString(size) +
                    ", which is not twice as wide as high; correct or remove the metadata, or "
                    "export the recording again");
  }
  layout.shown = *shown;
  layout.shown_from_image = Turn(metadata);
  return layout;
}

PanoramaPlacer::PanoramaPlacer(const PanoramaLayout& layout) : layout_(layout) {
  if (layout.is_turned()) {
    const EquirectangularCamera camera(layout.sphere.width, layout.sphere.height);
    const Eigen::Matrix3d image_from_shown = layout.shown_from_image.transpose();
    turn_.create(layout.sphere, CV_32FC2);
    for (int row = 0; row < turn_.rows; ++row) {
      for (int col = 0; col < turn_.cols; ++col) {
        const Eigen::Vector2d pixel =
            camera.Project(image_from_shown * camera.Bearing({col + 0.5, row + 0.5}));
        // Pixel centres of OpenCV are integers.
        turn_.at<cv::Vec2f>(row, col) = {static_cast<float>(pixel.x() - 0.5 + kSeamColumns),
                                         static_cast<float>(pixel.y() - 0.5)};
      }
    }
  }
  if (layout.is_cropped()) {
    coverage_ = cv::Mat::zeros(layout.sphere, CV_8U);
    coverage_(layout.place) = 255;
    if (layout.is_turned()) coverage_ = Turned(coverage_, cv::INTER_NEAREST);
  }
}

cv::Mat PanoramaPlacer::Turned(const cv::Mat& sphere, int interpolation) const {
  cv::Mat padded;
  cv::copyMakeBorder(sphere, padded, 0, 0, kSeamColumns, kSeamColumns, cv::BORDER_WRAP);
  cv::Mat turned;
  cv::remap(padded, turned, turn_, {}, interpolation, cv::BORDER_REPLICATE);
  return turned;
}

cv::Mat PanoramaPlacer::Place(const cv::Mat& stored) const {
  cv::Mat image = stored;
  if (layout_.eye.size() != stored.size()) image = stored(layout_.eye);
  if (layout_.is_cropped()) {
    cv::Mat sphere = cv::Mat::zeros(layout_.sphere, stored.type());
    image.copyTo(sphere(layout_.place));
    image = sphere;
  } else if (!image.isContinuous()) {
    image = image.clone();
  }
  return layout_.is_turned() ? Turned(image, cv::INTER_LINEAR) : image;
}

}  // namespace orb360
