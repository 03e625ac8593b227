#include "slam/stereo/rectified_sphere.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/stereo/rectified_sphere.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "slam/geometry/angle-inl.h"

#ifndef ORB360_SLAM_STEREO_RECTIFIED_SPHERE_CC_
#define ORB360_SLAM_STEREO_RECTIFIED_SPHERE_CC_
namespace orb360 {

// Directions whose three coordinates are column[x] * first + other_column[x] * second + third.
struct DirectionRow {
  const float* cosines;
  const float* sines;
  Eigen::Vector3f first;
  Eigen::Vector3f second;
  Eigen::Vector3f third;
};

// A sphere's image with a margin that continues it, so that four pixels are around every direction.
struct ContinuedImage {
  cv::Mat padded;  // begins kMargin pixels before the image in both directions
  cv::Size size;   // of the image
};

// Where the samples of a row lie: in pixels of a continued image, and by 1/256 of a pixel behind.
struct SamplePlaces {
  std::vector<int32_t> offset;
  std::vector<int32_t> right;
  std::vector<int32_t> down;
};

}  // namespace orb360
#endif

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;

constexpr float kPi = std::numbers::pi_v<float>;

struct Directions {
  VF x;
  VF y;
  VF z;
};

HWY_INLINE Directions LoadDirections(const DirectionRow& row, size_t i) {
  const DF d;
  const VF cosine = hn::LoadU(d, row.cosines + i);
  const VF sine = hn::LoadU(d, row.sines + i);
  const auto coordinate = [&](int k) HWY_ATTR {
    return hn::MulAdd(cosine, hn::Set(d, row.first[k]),
                      hn::MulAdd(sine, hn::Set(d, row.second[k]), hn::Set(d, row.third[k])));
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

HWY_INLINE VF Hypotenuse(VF a, VF b) { return hn::Sqrt(hn::MulAdd(a, a, hn::Mul(b, b))); }

// `count` directions, a multiple of the lanes. The pixel's centre is at half of its size.
void PlaceSamples(const DirectionRow& row, size_t count, const ContinuedImage& image,
                  SamplePlaces* places) {
  constexpr float kOne = 256;
  const DF d;
  const DI di;
  const auto width = static_cast<float>(image.size.width);
  const auto height = static_cast<float>(image.size.height);
  const auto stride = hn::Set(di, static_cast<int32_t>(image.padded.step1()));
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Directions direction = LoadDirections(row, i);
    const VF longitude = Angle(d, direction.y, hn::Neg(direction.x));
    const VF latitude = Angle(d, direction.z, Hypotenuse(direction.x, direction.y));
    // From the centre of the first pixel of the margin on.
    const VF u = hn::MulAdd(longitude, hn::Set(d, kOne * width / (2 * kPi)),
                            hn::Set(d, kOne * (0.5f * width + 0.5f)));
    const VF v = hn::MulAdd(latitude, hn::Set(d, -kOne * height / kPi),
                            hn::Set(d, kOne * (0.5f * height + 0.5f)));
    const auto clamp = [&](VF at, float size) HWY_ATTR {
      return hn::NearestInt(hn::Min(hn::Max(at, hn::Zero(d)), hn::Set(d, kOne * (size + 1) - 1)));
    };
    const auto column = clamp(u, width);
    const auto line = clamp(v, height);
    const auto fraction = hn::Set(di, static_cast<int32_t>(kOne) - 1);
    hn::StoreU(hn::Add(hn::Mul(hn::ShiftRight<8>(line), stride), hn::ShiftRight<8>(column)), di,
               places->offset.data() + i);
    hn::StoreU(hn::And(column, fraction), di, places->right.data() + i);
    hn::StoreU(hn::And(line, fraction), di, places->down.data() + i);
  }
}

// Samples continued rectified images of inverse ranges and their standard deviations.
void SampleRanges(const DirectionRow& row, size_t count, const ContinuedImage& values,
                  const ContinuedImage& sigmas, float* value, float* sigma) {
  const DF d;
  const DI di;
  const auto width = static_cast<float>(values.size.width);
  const auto height = static_cast<float>(values.size.height);
  const auto stride = hn::Set(di, static_cast<int32_t>(values.padded.step1()));
  const VF zero = hn::Zero(d);
  const auto* from = values.padded.ptr<float>();
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Directions direction = LoadDirections(row, i);
    const VF polar = Angle(d, Hypotenuse(direction.y, direction.z), direction.x);
    const VF turn = Angle(d, direction.z, direction.y);
    const VF azimuth = hn::Add(turn, hn::IfThenElseZero(hn::Lt(turn, zero), hn::Set(d, 2 * kPi)));
    const VF u = hn::Min(hn::MulAdd(polar, hn::Set(d, width / kPi), hn::Set(d, 0.5f)),
                         hn::Set(d, width + 0.5f));
    const VF v = hn::Min(hn::MulAdd(azimuth, hn::Set(d, width / kPi), hn::Set(d, 0.5f)),
                         hn::Set(d, height + 0.5f));
    const VF left = hn::Floor(u);
    const VF top = hn::Floor(v);
    const VF right_fraction = hn::Sub(u, left);
    const VF down_fraction = hn::Sub(v, top);
    const auto place = hn::Add(hn::Mul(hn::ConvertTo(di, top), stride), hn::ConvertTo(di, left));
    const auto one = hn::Set(di, 1);
    const VF upper_left = hn::GatherIndex(d, from, place);
    const VF upper_right = hn::GatherIndex(d, from, hn::Add(place, one));
    const VF lower_left = hn::GatherIndex(d, from, hn::Add(place, stride));
    const VF lower_right = hn::GatherIndex(d, from, hn::Add(hn::Add(place, stride), one));
    const VF half = hn::Set(d, 0.5f);
    const auto is_left = hn::Lt(right_fraction, half);
    const auto is_upper = hn::Lt(down_fraction, half);
    const VF nearest = hn::IfThenElse(is_upper, hn::IfThenElse(is_left, upper_left, upper_right),
                                      hn::IfThenElse(is_left, lower_left, lower_right));
    const VF least = hn::Min(hn::Min(upper_left, upper_right), hn::Min(lower_left, lower_right));
    const VF most = hn::Max(hn::Max(upper_left, upper_right), hn::Max(lower_left, lower_right));
    // Ranges that differ by this factor belong to different surfaces; 0 is unknown.
    constexpr float kEdgeRatio = 1.15f;
    const auto is_one_surface = hn::Lt(most, hn::Mul(hn::Set(d, kEdgeRatio), least));
    const VF above = hn::MulAdd(right_fraction, hn::Sub(upper_right, upper_left), upper_left);
    const VF below = hn::MulAdd(right_fraction, hn::Sub(lower_right, lower_left), lower_left);
    hn::StoreU(hn::IfThenElse(is_one_surface,
                              hn::MulAdd(down_fraction, hn::Sub(below, above), above), nearest),
               d, value + i);
    const auto nearest_place =
        hn::Add(hn::IfThenElseZero(hn::RebindMask(di, hn::Not(is_upper)), stride),
                hn::Add(hn::IfThenElseZero(hn::RebindMask(di, hn::Not(is_left)), one), place));
    hn::StoreU(hn::GatherIndex(d, sigmas.padded.ptr<float>(), nearest_place), d, sigma + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {
namespace {

HWY_EXPORT(PlaceSamples);
HWY_EXPORT(SampleRanges);

using std::numbers::pi;

// A multiple of the lanes of every instruction set.
constexpr size_t kMaxLanes = 16;
size_t RoundUp(int count) {
  return (static_cast<size_t>(count) + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
}

// One pixel more on each side. Beyond a pole an equirectangular image continues at the opposite
// longitude.
ContinuedImage ContinueEquirectangular(const cv::Mat& gray) {
  cv::Mat padded(gray.rows + 2, gray.cols + 2, gray.type());
  gray.copyTo(padded(cv::Rect({1, 1}, gray.size())));
  const int half = gray.cols / 2;
  for (const int row : {0, gray.rows - 1}) {
    const cv::Mat beyond = padded.row(row == 0 ? 0 : gray.rows + 1);
    gray(cv::Rect(half, row, gray.cols - half, 1)).copyTo(beyond.colRange(1, 1 + gray.cols - half));
    gray(cv::Rect(0, row, half, 1)).copyTo(beyond.colRange(1 + gray.cols - half, 1 + gray.cols));
  }
  padded.col(gray.cols).copyTo(padded.col(0));
  padded.col(1).copyTo(padded.col(gray.cols + 1));
  return {padded, gray.size()};
}

// One pixel more on each side. Rows of a rectified image are closed; beyond a column at the end
// nothing is known.
ContinuedImage ContinueRectified(const cv::Mat& image) {
  cv::Mat padded = cv::Mat::zeros(image.rows + 2, image.cols + 2, image.type());
  const cv::Range columns(1, image.cols + 1);
  image.copyTo(padded(cv::Rect({1, 1}, image.size())));
  image.row(image.rows - 1).copyTo(padded.row(0).colRange(columns));
  image.row(0).copyTo(padded.row(image.rows + 1).colRange(columns));
  return {padded, image.size()};
}

// Cosines and sines of the angles (i + 1/2) * step - start, up to a multiple of the lanes.
struct AngleTable {
  AngleTable(int count, double step, double start)
      : cosines(RoundUp(count)), sines(RoundUp(count)) {
    for (size_t i = 0; i < cosines.size(); ++i) {
      const double angle = (static_cast<double>(i) + 0.5) * step - start;
      cosines[i] = static_cast<float>(std::cos(angle));
      sines[i] = static_cast<float>(std::sin(angle));
    }
  }

  std::vector<float> cosines;
  std::vector<float> sines;
};

}  // namespace

Eigen::Matrix3d BaselineAxes(const Eigen::Vector3d& baseline) {
  Eigen::Matrix3d axes;
  axes.col(0) = baseline.normalized();
  int least = 0;  // the coordinate axis that is farthest from the baseline
  axes.col(0).cwiseAbs().minCoeff(&least);
  axes.col(1) = axes.col(0).cross(Eigen::Vector3d::Unit(least)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

Eigen::Vector3d RectifiedBearing(const Eigen::Vector2d& pixel, const Eigen::Matrix3d& axes,
                                 int width) {
  const double polar = pixel.x() * pi / width;
  const double azimuth = pixel.y() * pi / width;
  return axes * Eigen::Vector3d(std::cos(polar), std::sin(polar) * std::cos(azimuth),
                                std::sin(polar) * std::sin(azimuth));
}

Eigen::Vector2d RectifiedPixel(const Eigen::Vector3d& direction, const Eigen::Matrix3d& axes,
                               int width) {
  const Eigen::Vector3d local = axes.transpose() * direction;
  const double polar = std::atan2(std::hypot(local.y(), local.z()), local.x());
  double azimuth = std::atan2(local.z(), local.y());
  if (azimuth < 0) azimuth += 2 * pi;
  const double row = azimuth * width / pi;
  return {polar * width / pi, row < 2 * width ? row : 0.0};
}

cv::Mat RectifySphere(const cv::Mat& gray, const Eigen::Matrix3d& axes, int width) {
  const ContinuedImage image = ContinueEquirectangular(gray);
  const auto step = static_cast<ptrdiff_t>(image.padded.step1());
  const AngleTable polar(width, pi / width, 0);
  cv::Mat rectified(2 * width, width, CV_8U);
  SamplePlaces places;
  for (std::vector<int32_t>* list : {&places.offset, &places.right, &places.down}) {
    list->resize(RoundUp(width));
  }
  for (int row = 0; row < rectified.rows; ++row) {
    const double azimuth = (row + 0.5) * pi / width;
    const DirectionRow directions{
        polar.cosines.data(), polar.sines.data(), axes.col(0).cast<float>(),
        (std::cos(azimuth) * axes.col(1) + std::sin(azimuth) * axes.col(2)).cast<float>(),
        Eigen::Vector3f::Zero()};
    HWY_DYNAMIC_DISPATCH(PlaceSamples)(directions, RoundUp(width), image, &places);
    uint8_t* to = rectified.ptr(row);
    for (int x = 0; x < width; ++x) {
      const uint8_t* upper = image.padded.ptr() + places.offset[x];
      const uint8_t* lower = upper + step;
      const int right = places.right[x];
      const int down = places.down[x];
      const int above = upper[0] * (256 - right) + upper[1] * right;
      const int below = lower[0] * (256 - right) + lower[1] * right;
      to[x] = static_cast<uint8_t>((above * (256 - down) + below * down + (1 << 15)) >> 16);
    }
  }
  return rectified;
}

InverseRanges UnrectifySphere(const InverseRanges& rectified, const Eigen::Matrix3d& axes,
                              const cv::Size& size) {
  const ContinuedImage values = ContinueRectified(rectified.value);
  const ContinuedImage sigmas = ContinueRectified(rectified.sigma);
  const AngleTable longitudes(size.width, 2 * pi / size.width, pi);
  InverseRanges ranges{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
  std::vector<float> value(RoundUp(size.width));
  std::vector<float> sigma(RoundUp(size.width));
  for (int row = 0; row < size.height; ++row) {
    const double latitude = pi / 2 - (row + 0.5) * pi / size.height;
    // The camera's frame: -X forward, Y to the right, Z up; rows of the axes' transpose.
    const DirectionRow directions{longitudes.cosines.data(), longitudes.sines.data(),
                                  (-std::cos(latitude) * axes.row(0)).transpose().cast<float>(),
                                  (std::cos(latitude) * axes.row(1)).transpose().cast<float>(),
                                  (std::sin(latitude) * axes.row(2)).transpose().cast<float>()};
    HWY_DYNAMIC_DISPATCH(SampleRanges)
    (directions, value.size(), values, sigmas, value.data(), sigma.data());
    float* to = ranges.value.ptr<float>(row);
    for (int x = 0; x < size.width; ++x) to[x] = sigma[x] > 0 ? value[x] : 0;
    std::copy_n(sigma.data(), size.width, ranges.sigma.ptr<float>(row));
  }
  return ranges;
}

}  // namespace orb360
#endif
