#include "apps/town/image/stitch.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>

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

/// Returns pixel coordinates on a face, continuous (first centre at 0.5).
cv::Point2d ToPixel(const CubePoint& point, int size) {
  return {0.5 * size * (1 + point.right), 0.5 * size * (1 - point.up)};
}

/// Returns the pixel of a face that contains a point.
cv::Point NearestPixel(const CubePoint& point, int size) {
  const cv::Point2d p = ToPixel(point, size);
  return {std::clamp(static_cast<int>(p.x), 0, size - 1),
          std::clamp(static_cast<int>(p.y), 0, size - 1)};
}

/// Faces with a border that repeats the pixels of the neighbouring faces.
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

/// Position of a bilinear sample on a face with borders: the upper left of its four pixels, and the
/// offset from there.
struct SamplePlace {
  int x;
  int y;
  double across;
  double down;

  SamplePlace(int wide_size, const CubePoint& point) {
    const cv::Point2d p = ToPixel(point, wide_size - 2 * kBorder);
    const double right = p.x - 0.5 + kBorder;
    const double below = p.y - 0.5 + kBorder;
    x = std::clamp(static_cast<int>(right), 0, wide_size - 2);
    y = std::clamp(static_cast<int>(below), 0, wide_size - 2);
    across = right - x;
    down = below - y;
  }
};

/// The mean of bilinear samples of faces with borders.
class RadianceMean {
 public:
  explicit RadianceMean(CubeImages<cv::Vec3f> wide) : wide_(std::move(wide)) {}
  void Clear() { sum_ = {0, 0, 0}; }
  void Add(const CubePoint& point) {
    const cv::Mat3f& face = wide_[static_cast<size_t>(point.face)];
    const SamplePlace place(face.rows, point);
    const cv::Vec3f* upper = face[place.y] + place.x;
    const cv::Vec3f* lower = face[place.y + 1] + place.x;
    const auto wx = static_cast<float>(place.across);
    const auto wy = static_cast<float>(place.down);
    sum_ += (1 - wy) * ((1 - wx) * upper[0] + wx * upper[1]) +
            wy * ((1 - wx) * lower[0] + wx * lower[1]);
  }
  cv::Vec3f Of(int samples) const { return sum_ * (1.0F / static_cast<float>(samples)); }

 private:
  CubeImages<cv::Vec3f> wide_;
  cv::Vec3f sum_;
};

/// The same for 8-bit colours, with all channels in one integer and positions in 1/256 of a pixel.
class ColourMean {
 public:
  explicit ColourMean(const CubeImages<cv::Vec3b>& wide) {
    for (size_t i = 0; i < wide.size(); ++i) {
      faces_[i].create(wide[i].size());
      std::transform(wide[i].begin(), wide[i].end(), faces_[i].begin(),
                     [](const cv::Vec3b& c) { return c[0] | c[1] << 8 | c[2] << 16; });
    }
  }
  void Clear() { blue_green_ = red_ = 0; }
  void Add(const CubePoint& point) {
    const cv::Mat1i& face = faces_[static_cast<size_t>(point.face)];
    const SamplePlace place(face.rows, point);
    const int* upper = face[place.y] + place.x;
    const int* lower = face[place.y + 1] + place.x;
    const auto wx = static_cast<uint64_t>(256 * place.across + 0.5);
    const auto wy = static_cast<uint64_t>(256 * place.down + 0.5);
    const uint64_t both = wx * wy >> 8;  // the four weights add up to 256
    const uint64_t sum = (256 - wx - wy + both) * Spread(upper[0]) +
                         (wx - both) * Spread(upper[1]) + (wy - both) * Spread(lower[0]) +
                         both * Spread(lower[1]);
    blue_green_ += sum & 0x0000ffff0000ffffU;
    red_ += sum >> 16 & 0xffffU;
  }
  cv::Vec3b Of(int samples) const {
    const auto channel = [&](uint64_t sum) {
      return static_cast<uint8_t>((sum + static_cast<uint64_t>(128 * samples)) /
                                  static_cast<uint64_t>(256 * samples));
    };
    return {channel(blue_green_ & 0xffffffffU), channel(blue_green_ >> 32), channel(red_)};
  }

 private:
  /// Returns blue, red and green in 16 bits each, from the lowest upward.
  static uint64_t Spread(int colour) {
    const auto c = static_cast<uint64_t>(colour);
    return (c & 0xff00ffU) | (c & 0xff00U) << 24;
  }

  CubeImages<int> faces_;
  uint64_t blue_green_ = 0;
  uint64_t red_ = 0;
};

/// The points at which the directions through a grid of `per_pixel` by `per_pixel` positions in
/// each pixel meet the cube (as MeetCube), from tables over columns and rows: on a side face, the
/// coordinate to the right depends on the column only, and the height above the horizon is a
/// product.
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

/// Returns z at a point of a face (see StitchRange).
double SampleDepth(const cv::Mat1f& depth, const CubePoint& point) {
  const int size = depth.rows;
  const cv::Point pixel = NearestPixel(point, size);
  const float nearest = depth(pixel);
  if (nearest <= 0) return 0;
  // The slope of 1/z towards the side on which it changes less, or 0 if it bends both ways. At the
  // border of the face both neighbours are taken one pixel further inside.
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

/// Returns the number of samples along each side of a pixel that leave no gaps. Samples may be 2
/// pixels of a face apart, the width of a bilinear sample, at the face's corners, where its pixels
/// are smallest.
int SamplesAcross(int face_size, const EquirectangularCamera& camera) {
  constexpr double kStretch = 2.12;  // pixels a radian at a corner, over those at the centre
  const double footprint = kStretch * 0.5 * face_size * camera.AngleOfPixels(1);
  return std::max(2, static_cast<int>(std::ceil(footprint / 2)));
}

template <typename Mean, typename Pixel>
cv::Mat_<Pixel> Stitch(const CubeImages<Pixel>& faces, const EquirectangularCamera& camera) {
  Mean of_faces(AddBorders(faces));
  const int samples = SamplesAcross(SizeOf(faces), camera);
  const CubeGrid grid(camera, samples);
  cv::Mat_<Pixel> panorama(camera.height(), camera.width());
#pragma omp parallel for schedule(dynamic, 4) firstprivate(of_faces)
  for (int row = 0; row < panorama.rows; ++row) {
    for (int column = 0; column < panorama.cols; ++column) {
      of_faces.Clear();
      for (int y = row * samples; y < (row + 1) * samples; ++y) {
        for (int x = column * samples; x < (column + 1) * samples; ++x) of_faces.Add(grid.At(x, y));
      }
      panorama(row, column) = of_faces.Of(samples * samples);
    }
  }
  return panorama;
}

}  // namespace

cv::Mat3b StitchColour(const CubeImages<cv::Vec3b>& faces, const EquirectangularCamera& camera) {
  return Stitch<ColourMean>(faces, camera);
}

cv::Mat3f StitchRadiance(const CubeImages<cv::Vec3f>& faces, const EquirectangularCamera& camera) {
  return Stitch<RadianceMean>(faces, camera);
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
