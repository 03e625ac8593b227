#include "apps/town/image/stitch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "slam/check.h"

namespace orb360::town {
namespace {

constexpr int kBorder = 1;  // pixels around each face, taken from its neighbours

template <typename Pixel>
int SizeOf(const CubeImages<Pixel>& faces) {
  const int size = faces[0].rows;
  for (const cv::Mat_<Pixel>& face : faces)
    ORB360_CHECK(size > 0 && face.rows == size && face.cols == size, size, face.rows, face.cols);
  return size;
}

/// Pixel coordinates on a face, continuous (first centre at 0.5).
cv::Point2d ToPixel(const CubePoint& point, int size) {
  return {0.5 * size * (1 + point.right), 0.5 * size * (1 - point.up)};
}

/// The pixel of a face that a point is in.
cv::Point NearestPixel(const CubePoint& point, int size) {
  const cv::Point2d p = ToPixel(point, size);
  return {std::clamp(static_cast<int>(p.x), 0, size - 1),
          std::clamp(static_cast<int>(p.y), 0, size - 1)};
}

/// Faces with a border of what the neighbouring faces show there.
CubeImages<cv::Vec3b> AddBorders(const CubeImages<cv::Vec3b>& faces) {
  const int size = SizeOf(faces);
  CubeImages<cv::Vec3b> result;
  for (int face = 0; face < kCubeFaces; ++face) {
    cv::Mat3b& wide = result[static_cast<size_t>(face)];
    cv::copyMakeBorder(faces[static_cast<size_t>(face)], wide, kBorder, kBorder, kBorder, kBorder,
                       cv::BORDER_REPLICATE);
    const Eigen::Quaterniond camera_from_face = CameraFromFace(face);
    const auto fill = [&](int x, int y) {
      const Eigen::Vector3d direction(-1, 2 * (x - kBorder + 0.5) / size - 1,
                                      1 - 2 * (y - kBorder + 0.5) / size);
      const CubePoint point = MeetCube(camera_from_face * direction);
      wide(y, x) = faces[static_cast<size_t>(point.face)](NearestPixel(point, size));
    };
    for (int i = 0; i < wide.rows; ++i) {
      fill(i, 0);
      fill(i, wide.rows - 1);
      fill(0, i);
      fill(wide.rows - 1, i);
    }
  }
  return result;
}

/// Bilinear sample of a face with borders.
cv::Vec3d Sample(const cv::Mat3b& wide, const CubePoint& point) {
  const cv::Point2d p = ToPixel(point, wide.rows - 2 * kBorder);
  const double x = p.x - 0.5 + kBorder;
  const double y = p.y - 0.5 + kBorder;
  const int x0 = std::clamp(static_cast<int>(x), 0, wide.cols - 2);
  const int y0 = std::clamp(static_cast<int>(y), 0, wide.rows - 2);
  const double wx = x - x0;
  const double wy = y - y0;
  return (1 - wy) * ((1 - wx) * cv::Vec3d(wide(y0, x0)) + wx * cv::Vec3d(wide(y0, x0 + 1))) +
         wy * ((1 - wx) * cv::Vec3d(wide(y0 + 1, x0)) + wx * cv::Vec3d(wide(y0 + 1, x0 + 1)));
}

/// Bearings of a grid with `per_pixel` places to either side of a pixel, in its middle if there is
/// one: from tables over the columns and the rows.
class BearingGrid {
 public:
  BearingGrid(const EquirectangularCamera& camera, int per_pixel) {
    for (int i = 0; i < camera.width() * per_pixel; ++i)
      horizontal_.push_back(camera.Bearing({(i + 0.5) / per_pixel, camera.cy()}));
    for (int i = 0; i < camera.height() * per_pixel; ++i) {
      const Eigen::Vector3d bearing = camera.Bearing({camera.cx(), (i + 0.5) / per_pixel});
      latitude_.emplace_back(-bearing.x(), bearing.z());
    }
  }
  Eigen::Vector3d At(int column, int row) const {
    const Eigen::Vector3d& horizontal = horizontal_[static_cast<size_t>(column)];
    const Eigen::Vector2d& latitude = latitude_[static_cast<size_t>(row)];
    return {latitude.x() * horizontal.x(), latitude.x() * horizontal.y(), latitude.y()};
  }

 private:
  std::vector<Eigen::Vector3d> horizontal_;
  std::vector<Eigen::Vector2d> latitude_;  // cosine, sine
};

/// z at a point of a face: see StitchRange.
double SampleDepth(const cv::Mat1f& depth, const CubePoint& point) {
  constexpr double kEdge = 1.05;  // ratio of depths at which a surface ends
  const int size = depth.rows;
  const cv::Point2d p = ToPixel(point, size);
  const float nearest = depth(NearestPixel(point, size));
  const double x = std::clamp(p.x - 0.5, 0.0, size - 1.0);
  const double y = std::clamp(p.y - 0.5, 0.0, size - 1.0);
  const int x0 = std::min(static_cast<int>(x), size - 2);
  const int y0 = std::min(static_cast<int>(y), size - 2);
  const double z00 = depth(y0, x0);
  const double z01 = depth(y0, x0 + 1);
  const double z10 = depth(y0 + 1, x0);
  const double z11 = depth(y0 + 1, x0 + 1);
  const double least = std::min({z00, z01, z10, z11});
  if (least <= 0 || std::max({z00, z01, z10, z11}) > kEdge * least) return nearest;
  // Half a pixel beyond the outermost centres it extrapolates, so that planes stay planes up to
  // the border.
  const double wx = p.x - 0.5 - x0;
  const double wy = p.y - 0.5 - y0;
  return 1 / ((1 - wy) * ((1 - wx) / z00 + wx / z01) + wy * ((1 - wx) / z10 + wx / z11));
}

}  // namespace

cv::Mat3b StitchColour(const CubeImages<cv::Vec3b>& faces, const EquirectangularCamera& camera) {
  const CubeImages<cv::Vec3b> wide = AddBorders(faces);
  const BearingGrid grid(camera, 2);
  cv::Mat3b panorama(camera.height(), camera.width());
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < panorama.rows; ++row) {
    for (int column = 0; column < panorama.cols; ++column) {
      cv::Vec3d sum(0, 0, 0);
      for (const int y : {2 * row, 2 * row + 1}) {
        for (const int x : {2 * column, 2 * column + 1}) {
          const CubePoint point = MeetCube(grid.At(x, y));
          sum += Sample(wide[static_cast<size_t>(point.face)], point);
        }
      }
      for (int channel = 0; channel < 3; ++channel)
        panorama(row, column)[channel] = static_cast<uint8_t>(0.25 * sum[channel] + 0.5);
    }
  }
  return panorama;
}

cv::Mat1f StitchRange(const CubeImages<float>& depth, const EquirectangularCamera& camera) {
  ORB360_CHECK(SizeOf(depth) >= 2);
  const BearingGrid grid(camera, 1);
  cv::Mat1f range(camera.height(), camera.width());
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const CubePoint point = MeetCube(grid.At(column, row));
      const double z = SampleDepth(depth[static_cast<size_t>(point.face)], point);
      range(row, column) =
          static_cast<float>(z * std::sqrt(1 + point.right * point.right + point.up * point.up));
    }
  }
  return range;
}

cv::Mat1f DecodeDepth24(const cv::Mat& image, double farthest) {
  ORB360_CHECK(image.depth() == CV_8U && image.channels() >= 3, image.type());
  constexpr double kLargest = (1 << 24) - 1;
  cv::Mat1f depth(image.size());
  const int channels = image.channels();
  for (int row = 0; row < image.rows; ++row) {
    const uint8_t* pixel = image.ptr<uint8_t>(row);
    for (int column = 0; column < image.cols; ++column, pixel += channels) {
      const int number = pixel[2] + 256 * pixel[1] + 65536 * pixel[0];
      depth(row, column) = number == static_cast<int>(kLargest)
                               ? 0.0F
                               : static_cast<float>(number / kLargest * farthest);
    }
  }
  return depth;
}

}  // namespace orb360::town
