#include "slam/features/patch_descriptor.h"

#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "slam/features/comparison_pattern.h"
#include "slam/features/sphere_pyramid.h"
#include "tests/dispatch_targets.h"

namespace orb360 {
namespace {

// White noise: a sample one pixel off has nothing to do with the right one.
cv::Mat Noise(int width, int height) {
  cv::Mat image(height + 2 * PyramidLevel::kMarginY, width + 2 * PyramidLevel::kMarginX, CV_8U);
  std::mt19937 random(width + height);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image.at<uint8_t>(y, x) = random() % 256;
  }
  for (int y = 0; y < image.rows; ++y) {  // continuous around the sphere
    uint8_t* row = image.ptr(y);
    std::copy_n(row + width, PyramidLevel::kMarginX, row);
    std::copy_n(row + PyramidLevel::kMarginX, PyramidLevel::kMarginX,
                row + PyramidLevel::kMarginX + width);
  }
  return image;
}

struct Patch {
  EquirectangularCamera level;
  int band_width;
  int u;
  int v;
  cv::Mat padded;

  TangentSampling Sampling() const { return {level, band_width, u, v}; }
  OrientedDescriptor Describe() const {
    return DescribePatch(padded.ptr(v + PyramidLevel::kMarginY) + u + PyramidLevel::kMarginX,
                         static_cast<ptrdiff_t>(padded.step), Sampling());
  }

  // The pixel at tangent coordinates, by a ray in three dimensions and double precision.
  int Sample(double east, double south) const {
    const double fx = band_width / (2 * M_PI);
    const double fy = level.height() / M_PI;
    const double k = 2 * M_PI / level.width();
    const double latitude = M_PI / 2 - (v + 0.5) / fy;
    const Eigen::Vector3d center(std::cos(latitude), 0, std::sin(latitude));
    const Eigen::Vector3d to_east(0, 1, 0);
    const Eigen::Vector3d to_south(std::sin(latitude), 0, -std::cos(latitude));
    const Eigen::Vector3d ray = (center + k * east * to_east + k * south * to_south).normalized();
    const int row = static_cast<int>((M_PI / 2 - std::asin(ray.z())) * fy);
    const int offset = static_cast<int>(std::lround(fx * std::atan2(ray.y(), ray.x())));
    const int column = ((u + offset) % band_width + band_width) % band_width;
    return padded.at<uint8_t>(row + PyramidLevel::kMarginY, column + PyramidLevel::kMarginX);
  }

  Descriptor Reference(double angle) const {
    const ComparisonPattern& pattern = DescriptorPattern();
    const auto sample = [&](double a, double b) {
      return Sample(std::cos(angle) * a - std::sin(angle) * b,
                    std::sin(angle) * a + std::cos(angle) * b);
    };
    Descriptor bits = {};
    for (int i = 0; i < ComparisonPattern::kPairs; ++i) {
      const bool darker = sample(pattern.first_east[i], pattern.first_south[i]) <
                          sample(pattern.second_east[i], pattern.second_south[i]);
      bits[i / 64] |= static_cast<uint64_t>(darker) << (i % 64);
    }
    return bits;
  }
};

int DifferingBits(const Descriptor& a, const Descriptor& b) {
  int count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += __builtin_popcountll(a[i] ^ b[i]);
  return count;
}

struct Tally {
  int patches = 0;
  int wrong_bits = 0;
  double Fraction() const { return wrong_bits / (256.0 * patches); }
};

// Patches from pole to pole on levels of several sizes, in bands compressed like the sphere.
std::map<TangentSampling::Order, Tally> CountWrongBits() {
  std::map<TangentSampling::Order, Tally> tallies;
  for (const int width : {192, 448, 1024, 2048}) {
    const int height = width / 2;
    for (const double compression : {1.0, 0.5, 0.2}) {
      const int band_width = static_cast<int>(width * compression) / 32 * 32;
      const cv::Mat padded = Noise(band_width, height);
      for (int v = height / 80; v < height; v += height / 40) {
        const double cosine = std::sin(M_PI * (v + 0.5) / height);
        if (cosine > 1.5 * compression || cosine < compression / 1.5) continue;
        const Patch patch{{width, height}, band_width, band_width / 3, v, padded};
        const OrientedDescriptor found = patch.Describe();
        Tally& tally = tallies[patch.Sampling().order];
        tally.wrong_bits += DifferingBits(found.bits, patch.Reference(found.angle));
        ++tally.patches;
      }
    }
  }
  return tallies;
}

TEST(PatchDescriptor, ComparesThePointsOfTheTangentPlane) {
  using Order = TangentSampling::Order;
  ForEachDispatchTarget([] {
    std::map<Order, Tally> tallies = CountWrongBits();
    for (const Order order : {Order::kSecond, Order::kSeries, Order::kExact}) {
      EXPECT_GT(tallies[order].patches, 30) << static_cast<int>(order);
    }
    EXPECT_LT(tallies[Order::kExact].Fraction(), 0.002);
    EXPECT_LT(tallies[Order::kSeries].Fraction(), 0.01);
    EXPECT_LT(tallies[Order::kSecond].Fraction(), 0.04);
  });
}

}  // namespace
}  // namespace orb360
