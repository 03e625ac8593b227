#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {

/// A procedural image on the sphere, to be seen in any orientation: rectangles of all sizes and
/// directions, one over the other, and noise of several octaves on top. Band-limited by
/// construction, so that one sample a pixel is enough: edges are `smoothing` radians wide, and the
/// finest noise has a lattice of four times that.
class SphereTexture {
 public:
  SphereTexture(unsigned seed, double smoothing) : seed_(seed), smoothing_(smoothing) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * (random() + 0.5) / 4294967296.0;
    };
    constexpr int kRectangles = 12000;
    for (int i = 0; i < kRectangles; ++i) {
      Eigen::Quaterniond q(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (q.norm() > 1 || q.norm() < 0.1) continue;  // within the ball: uniform over rotations
      // The large ones first, the small ones over them.
      const double size = 0.3 * std::pow(0.03, i / static_cast<double>(kRectangles));
      rectangles_.push_back(
          {q.normalized().toRotationMatrix(), size, size * uniform(0.3, 1.0), uniform(20, 235)});
    }
    cells_.resize(kCells * kCells * kCells);
    for (size_t r = 0; r < rectangles_.size(); ++r) {
      const Eigen::Vector3d center = rectangles_[r].axes.col(2);
      const double reach = std::hypot(rectangles_[r].width, rectangles_[r].height) + smoothing_;
      const Eigen::Array3i low = Cell(center.array() - reach);
      const Eigen::Array3i high = Cell(center.array() + reach);
      for (int x = low.x(); x <= high.x(); ++x) {
        for (int y = low.y(); y <= high.y(); ++y) {
          for (int z = low.z(); z <= high.z(); ++z) {
            cells_[(x * kCells + y) * kCells + z].push_back(static_cast<int>(r));
          }
        }
      }
    }
  }

  /// Grey level in the direction of a unit vector.
  double operator()(const Eigen::Vector3d& direction) const {
    double grey = 128;
    const Eigen::Array3i c = Cell(direction.array());
    for (const int r : cells_[(c.x() * kCells + c.y()) * kCells + c.z()]) {
      const Rectangle& rectangle = rectangles_[r];
      const Eigen::Vector3d local = rectangle.axes.transpose() * direction;
      if (local.z() <= 0) continue;
      const double cover = Edge(rectangle.width - std::abs(local.x())) *
                           Edge(rectangle.height - std::abs(local.y()));
      grey += cover * (rectangle.grey - grey);
    }
    double amplitude = 9;
    double frequency = 0.25 / smoothing_;
    for (int octave = 0; octave < 4; ++octave) {
      grey += amplitude * Noise(direction * frequency, octave);
      frequency *= 0.5;
      amplitude *= 1.3;
    }
    return std::clamp(grey, 0.0, 255.0);
  }

  /// The panorama of a camera at the sphere's centre, with sensor noise of `noise` grey levels.
  cv::Mat Render(const EquirectangularCamera& camera, const Eigen::Quaterniond& world_from_camera,
                 double noise = 0) const {
    cv::Mat image(camera.height(), camera.width(), CV_8U);
    const Eigen::Matrix3d rotation = world_from_camera.toRotationMatrix();
#pragma omp parallel for schedule(dynamic, 16)
    for (int v = 0; v < image.rows; ++v) {
      std::mt19937 random(seed_ + 7919 * v + static_cast<unsigned>(1e6 * (rotation(0, 0) + 1)));
      std::normal_distribution<double> gauss(0, 1);
      for (int u = 0; u < image.cols; ++u) {
        const double grey = (*this)(rotation * camera.Bearing({u + 0.5, v + 0.5}));
        image.at<uint8_t>(v, u) = cv::saturate_cast<uint8_t>(grey + noise * gauss(random));
      }
    }
    return image;
  }

 private:
  struct Rectangle {
    Eigen::Matrix3d axes;  // columns: along the width, along the height, towards the centre
    double width;          // half sizes, as sines
    double height;
    double grey;
  };
  static constexpr int kCells = 24;  // a side, of the cube around the sphere

  static Eigen::Array3i Cell(const Eigen::Array3d& p) {
    return ((p + 1) * (0.5 * kCells)).floor().cast<int>().max(0).min(kCells - 1);
  }
  double Edge(double inside) const {
    const double t = std::clamp(0.5 + inside / smoothing_, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  }
  // Gradient noise (Perlin, Improving Noise, SIGGRAPH 2002) in about [-1, 1].
  double Noise(const Eigen::Vector3d& p, uint32_t octave) const {
    const Eigen::Array3d base = p.array().floor();
    const Eigen::Array3d f = p.array() - base;
    const Eigen::Array3d s = f * f * f * (f * (f * 6 - 15) + 10);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Array3d offset(corner & 1, (corner >> 1) & 1, corner >> 2);
      const Eigen::Array3d weight = offset * s + (1 - offset) * (1 - s);
      sum += weight.prod() * Gradient((base + offset).cast<int>(), octave, f - offset);
    }
    return sum;
  }
  double Gradient(const Eigen::Array3i& lattice, uint32_t octave, const Eigen::Array3d& d) const {
    uint32_t h = seed_ + 0x9E3779B9u * (octave + 1);
    for (const int i : {lattice.x(), lattice.y(), lattice.z()}) {
      h = (h ^ static_cast<uint32_t>(i)) * 0x85EBCA6Bu;
      h ^= h >> 15;
    }
    static constexpr std::array<std::array<int, 3>, 12> kEdges = {{{1, 1, 0},
                                                                   {-1, 1, 0},
                                                                   {1, -1, 0},
                                                                   {-1, -1, 0},
                                                                   {1, 0, 1},
                                                                   {-1, 0, 1},
                                                                   {1, 0, -1},
                                                                   {-1, 0, -1},
                                                                   {0, 1, 1},
                                                                   {0, -1, 1},
                                                                   {0, 1, -1},
                                                                   {0, -1, -1}}};
    const std::array<int, 3>& g = kEdges[(uint64_t{h} * 12) >> 32];
    return g[0] * d.x() + g[1] * d.y() + g[2] * d.z();
  }

  unsigned seed_;
  double smoothing_;
  std::vector<Rectangle> rectangles_;
  std::vector<std::vector<int>> cells_;  // rectangles that may be seen, in order, by cell
};

}  // namespace orb360
