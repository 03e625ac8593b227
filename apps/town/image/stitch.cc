#include "apps/town/image/stitch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "nn/base/check.h"

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
template <typename Pixel>
CubeImages<Pixel> AddBorders(const CubeImages<Pixel>& faces) {
  const int size = SizeOf(faces);
  CubeImages<Pixel> result;
  for (int face = 0; face < kCubeFaces; ++face) {
    cv::Mat_<Pixel>& wide = result[static_cast<size_t>(face)];
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
template <typename Pixel>
cv::Vec3f Sample(const cv::Mat_<Pixel>& wide, const CubePoint& point) {
  const cv::Point2d p = ToPixel(point, wide.rows - 2 * kBorder);
  const double x = p.x - 0.5 + kBorder;
  const double y = p.y - 0.5 + kBorder;
  const int x0 = std::clamp(static_cast<int>(x), 0, wide.cols - 2);
  const int y0 = std::clamp(static_cast<int>(y), 0, wide.rows - 2);
  const auto wx = static_cast<float>(x - x0);
  const auto wy = static_cast<float>(y - y0);
  const Pixel* upper = wide[y0] + x0;
  const Pixel* lower = wide[y0 + 1] + x0;
  cv::Vec3f result;
  for (int channel = 0; channel < 3; ++channel) {
    result[channel] = (1 - wy) * ((1 - wx) * upper[0][channel] + wx * upper[1][channel]) +
                      wy * ((1 - wx) * lower[0][channel] + wx * lower[1][channel]);
  }
  return result;
}

/// Where the directions through a grid of `per_pixel` by `per_pixel` places in each pixel meet the
/// cube (as MeetCube), from tables over the columns and the rows: on a side, the place to the right
/// depends on the column alone, and the height above the horizon is a product.
class CubeGrid {
 public:
  CubeGrid(const EquirectangularCamera& camera, int per_pixel) {
    for (int i = 0; i < camera.width() * per_pixel; ++i) {
      const Eigen::Vector3d bearing = camera.Bearing({(i + 0.5) / per_pixel, camera.cy()});
      columns_.push_back({MeetCube(bearing), bearing.x(), bearing.y(),
                          1 / std::max(std::abs(bearing.x()), std::abs(bearing.y()))});
    }
    for (int i = 0; i < camera.height() * per_pixel; ++i) {
      const Eigen::Vector3d bearing = camera.Bearing({camera.cx(), (i + 0.5) / per_pixel});
      rows_.push_back({bearing.z() / -bearing.x(), -bearing.x() / std::abs(bearing.z())});
    }
  }
  CubePoint At(int column, int row) const {
    const Column& across = columns_[static_cast<size_t>(column)];
    const Row& down = rows_[static_cast<size_t>(row)];
    const double up = down.tangent * across.secant;
    if (std::abs(up) <= 1) return {across.horizon.face, across.horizon.right, up};
    const double right = down.cotangent * across.y;
    return up > 0 ? CubePoint{kUp, right, down.cotangent * across.x}
                  : CubePoint{kDown, right, -down.cotangent * across.x};
  }

 private:
  struct Column {
    CubePoint horizon;  // where its place on the horizon meets the cube
    double x;           // of the bearing there
    double y;
    double secant;  // of the angle from the axis of that face
  };
  struct Row {
    double tangent;    // of the latitude
    double cotangent;  // of its size
  };
  std::vector<Column> columns_;
  std::vector<Row> rows_;
};

/// z at a point of a face: see StitchRange.
double SampleDepth(const cv::Mat1f& depth, const CubePoint& point) {
  const int size = depth.rows;
  const cv::Point pixel = NearestPixel(point, size);
  const float nearest = depth(pixel);
  if (nearest <= 0) return 0;
  // The slope of 1/z to that side on which it changes less; 0 where it bends both ways. At the
  // border of the face both sides are taken one pixel further in.
  const auto slope = [&](const cv::Point& middle, const cv::Point& step) {
    const float before = depth(middle - step);
    const float here = depth(middle);
    const float after = depth(middle + step);
    if (before <= 0 || here <= 0 || after <= 0) return 0.0;
    const double a = 1.0 / here - 1.0 / before;
    const double b = 1.0 / after - 1.0 / here;
    if (a * b <= 0) return 0.0;
    return std::abs(a) < std::abs(b) ? a : b;
  };
  const cv::Point2d p = ToPixel(point, size);
  const double across = slope({std::clamp(pixel.x, 1, size - 2), pixel.y}, {1, 0});
  const double down = slope({pixel.x, std::clamp(pixel.y, 1, size - 2)}, {0, 1});
  return 1 / (1.0 / nearest + across * (p.x - 0.5 - pixel.x) + down * (p.y - 0.5 - pixel.y));
}

/// How many samples along each side of a pixel leave no gaps: they may lie 2 pixels of a face
/// apart, the width of a bilinear sample, at the face's corners, where its pixels are smallest.
int SamplesAcross(int face_size, const EquirectangularCamera& camera) {
  constexpr double kStretch = 2.12;  // pixels a radian at a corner, over those at the centre
  const double footprint = kStretch * 0.5 * face_size * camera.AngleOfPixels(1);
  return std::max(2, static_cast<int>(std::ceil(footprint / 2)));
}

template <typename Pixel>
cv::Mat_<Pixel> Stitch(const CubeImages<Pixel>& faces, const EquirectangularCamera& camera) {
  const CubeImages<Pixel> wide = AddBorders(faces);
  const int samples = SamplesAcross(SizeOf(faces), camera);
  const float weight = 1.0F / static_cast<float>(samples * samples);
  const CubeGrid grid(camera, samples);
  cv::Mat_<Pixel> panorama(camera.height(), camera.width());
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < panorama.rows; ++row) {
    for (int column = 0; column < panorama.cols; ++column) {
      cv::Vec3f sum(0, 0, 0);
      for (int y = row * samples; y < (row + 1) * samples; ++y) {
        for (int x = column * samples; x < (column + 1) * samples; ++x) {
          const CubePoint point = grid.At(x, y);
          sum += Sample(wide[static_cast<size_t>(point.face)], point);
        }
      }
      panorama(row, column) = Pixel(sum * weight);  // rounds
    }
  }
  return panorama;
}

}  // namespace

cv::Mat3b StitchColour(const CubeImages<cv::Vec3b>& faces, const EquirectangularCamera& camera) {
  return Stitch(faces, camera);
}

cv::Mat3f StitchRadiance(const CubeImages<cv::Vec3f>& faces, const EquirectangularCamera& camera) {
  return Stitch(faces, camera);
}

cv::Mat1f StitchRange(const CubeImages<float>& depth, const EquirectangularCamera& camera) {
  ORB360_CHECK(SizeOf(depth) >= 3);
  const CubeGrid grid(camera, 1);
  cv::Mat1f range(camera.height(), camera.width());
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const CubePoint point = grid.At(column, row);
      const double z = SampleDepth(depth[static_cast<size_t>(point.face)], point);
      range(row, column) =
          static_cast<float>(z * std::sqrt(1 + point.right * point.right + point.up * point.up));
    }
  }
  return range;
}

cv::Mat1w StitchObjects(const CubeImages<uint16_t>& objects, const EquirectangularCamera& camera) {
  const int size = SizeOf(objects);
  const CubeGrid grid(camera, 1);
  cv::Mat1w panorama(camera.height(), camera.width());
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < panorama.rows; ++row) {
    for (int column = 0; column < panorama.cols; ++column) {
      const CubePoint point = grid.At(column, row);
      panorama(row, column) = objects[static_cast<size_t>(point.face)](NearestPixel(point, size));
    }
  }
  return panorama;
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
