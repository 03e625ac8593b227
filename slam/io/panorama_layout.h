#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace orb360 {

/// How the images of both eyes lie in one stereo image.
enum class StereoMode { kMono, kTopBottom, kLeftRight };

/// What a file says of the panorama that its images show. All of it is optional.
struct PanoramaMetadata {
  /// The file says that its images are equirectangular.
  bool is_equirectangular = false;
  StereoMode stereo = StereoMode::kMono;
  /// The left eye is the first of both: the upper or the left one.
  bool is_left_first = true;
  /// Fractions of the sphere's width (left, right) and height (top, bottom) that are missing.
  struct Crop {
    double left = 0.0;
    double top = 0.0;
    double right = 0.0;
    double bottom = 0.0;

    bool operator==(const Crop&) const = default;
  };
  std::optional<Crop> crop;
  /// How the sphere is turned after the image was mapped onto it, degrees: a positive yaw moves
  /// what is in front to the right, a positive pitch upwards, and a positive roll turns it
  /// clockwise; roll first, then pitch, then yaw.
  double yaw = 0.0;
  double pitch = 0.0;
  double roll = 0.0;
};

/// Where the pixels of an image lie on the full sphere.
struct PanoramaLayout {
  /// The part of the stored image that is used: one eye.
  cv::Rect eye;
  /// Size of the full sphere in stored pixels, and the eye's place in it.
  cv::Size sphere;
  cv::Rect place;
  /// Size of the full sphere with square pixels.
  cv::Size shown;
  /// Rotation of the camera frame by yaw, pitch and roll: direction as shown from that in the
  /// image.
  Eigen::Matrix3d shown_from_image = Eigen::Matrix3d::Identity();

  bool is_cropped() const { return place.size() != sphere; }
  bool is_turned() const { return !shown_from_image.isIdentity(); }
};

/// Returns the layout of images of `stored` pixels whose pixels are shown `sample_aspect` times as
/// wide as high. An image that is a full sphere as stored is used as it is. Throws UserError, whose
/// message begins with `name`, where image and metadata do not make a full sphere.
PanoramaLayout MakePanoramaLayout(const std::string& name, cv::Size stored, double sample_aspect,
                                  const PanoramaMetadata& metadata);

/// Brings images of one layout to the full sphere.
class PanoramaPlacer {
 public:
  explicit PanoramaPlacer(const PanoramaLayout& layout);

  /// Returns the full sphere in stored pixels, layout.sphere, black where the image shows nothing.
  cv::Mat Place(const cv::Mat& stored) const;

  /// Mask of layout.sphere, CV_8U: 255 where the image shows something, 0 elsewhere; empty where it
  /// shows everything.
  const cv::Mat& coverage() const { return coverage_; }

 private:
  cv::Mat Turned(const cv::Mat& sphere, int interpolation) const;

  PanoramaLayout layout_;
  cv::Mat turn_;  // pixel of the image for each pixel as shown, CV_32FC2; empty if it is not turned
  cv::Mat coverage_;
};

}  // namespace orb360
