// The SIMD kernels of slam/features against plain loops, on every instruction set that runs here.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "slam/features/blur.h"
#include "slam/features/epipolar_scan.h"
#include "slam/features/fast_score.h"
#include "slam/features/hamming.h"
#include "slam/features/row_resample.h"
#include "tests/dispatch_targets.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

cv::Mat RandomImage(int rows, int cols, unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat image(rows, cols, CV_8U);
  // Flat patches with noise: some pixels are corners, most are not.
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      const unsigned patch = (y / 7 * 31 + x / 5 * 17) * 2654435761u >> 24;
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(static_cast<int>(patch) +
                                                           static_cast<int>(random() % 21) - 10);
    }
  }
  return image;
}

// From the definition: the best arc of 9 of the smallest difference.
int PlainFastScore(const cv::Mat& image, int y, int x) {
  constexpr int kCircle[16][2] = {{0, -3}, {1, -3},  {2, -2},  {3, -1}, {3, 0},  {3, 1},
                                  {2, 2},  {1, 3},   {0, 3},   {-1, 3}, {-2, 2}, {-3, 1},
                                  {-3, 0}, {-3, -1}, {-2, -2}, {-1, -3}};
  int best = 0;
  for (const int sign : {1, -1}) {
    for (int start = 0; start < 16; ++start) {
      int least = 255;
      for (int i = start; i < start + 9; ++i) {
        const int c = image.at<uint8_t>(y + kCircle[i % 16][1], x + kCircle[i % 16][0]);
        least = std::min(least, sign * (c - image.at<uint8_t>(y, x)));
      }
      best = std::max(best, least);
    }
  }
  return best;
}

TEST(FastScore, IsTheBestArcOfNine) {
  for (const int width : {1, 15, 16, 33, 64, 100, 257}) {
    const cv::Mat image = RandomImage(8, width + 6, width);
    ForEachDispatchTarget([&] {
      constexpr uint8_t kMin = 5;
      std::vector<uint8_t> scores(width);
      FastScoreRow(image.ptr(4) + 3, static_cast<ptrdiff_t>(image.step), width, kMin,
                   scores.data());
      for (int x = 0; x < width; ++x) {
        const int expected = PlainFastScore(image, 4, x + 3);
        ASSERT_EQ(scores[x], expected >= kMin ? expected : 0) << "x " << x << " of " << width;
      }
    });
  }
}

TEST(FastScore, MaximaAreThoseOfThe3x3NeighbourhoodOneOfEachPlateau) {
  std::mt19937 random(3);
  for (const int width : {1, 17, 64, 131}) {
    cv::Mat scores(3, width + 2, CV_8U);
    for (int i = 0; i < static_cast<int>(scores.total()); ++i) {
      scores.data[i] = static_cast<uint8_t>(random() % 6 * 10);  // many equals
    }
    ForEachDispatchTarget([&] {
      std::vector<int> found;
      FastMaximaRow(scores.ptr(0) + 1, scores.ptr(1) + 1, scores.ptr(2) + 1, width, 20, &found);
      std::vector<int> expected;
      for (int x = 1; x <= width; ++x) {
        const int s = scores.at<uint8_t>(1, x);
        bool maximum =
            s >= 20 && s > scores.at<uint8_t>(1, x - 1) && s >= scores.at<uint8_t>(1, x + 1);
        for (int dx = -1; dx <= 1; ++dx) {
          maximum =
              maximum && s > scores.at<uint8_t>(0, x + dx) && s >= scores.at<uint8_t>(2, x + dx);
        }
        if (maximum) expected.push_back(x - 1);
      }
      ASSERT_EQ(found, expected) << width;
    });
  }
}

TEST(RowResample, BlendsTwoRowsRoundedToNearest) {
  const cv::Mat image = RandomImage(2, 131, 9);
  for (const int weight : {0, 1, 50, 128}) {
    ForEachDispatchTarget([&] {
      std::vector<uint8_t> blended(131);
      BlendRows(image.ptr(0), image.ptr(1), weight, 131, blended.data());
      for (int x = 0; x < 131; ++x) {
        const double w = weight / 128.0;
        const double exact = (1 - w) * image.at<uint8_t>(0, x) + w * image.at<uint8_t>(1, x);
        ASSERT_EQ(blended[x], std::floor(exact + 0.5)) << x;
      }
    });
  }
}

// 64: samples too far apart for a register; 161: a rest that fills none.
TEST(RowResample, IsBilinearFromCentreToCentre) {
  constexpr int kSource = 192;
  const cv::Mat image = RandomImage(1, kSource + 2 + kResampleReach, 9);
  for (const int target : {64, 96, 160, 161, 192}) {
    const ResampleTaps taps(kSource, target);
    ForEachDispatchTarget([&] {
      std::vector<uint8_t> out(target);
      ResampleRow(image.ptr(0) + 1, taps, out.data());
      for (int x = 0; x < target; ++x) {
        const double at = (x + 0.5) * kSource / target - 0.5 + 1.0;
        const int i = static_cast<int>(std::floor(at));
        const double t = at - i;
        // Weights are rounded to 1/128: up to one grey level, and half for the result.
        ASSERT_NEAR(out[x], (1 - t) * image.at<uint8_t>(0, i) + t * image.at<uint8_t>(0, i + 1),
                    1.5)
            << x;
      }
    });
  }
}

TEST(RowResample, ShrinksARowInPlace) {
  const cv::Mat image = RandomImage(1, 640 + 1 + kResampleReach, 2);
  const ResampleTaps taps(640, 352);
  ForEachDispatchTarget([&] {
    std::vector<uint8_t> apart(352);
    ResampleRow(image.ptr(0), taps, apart.data());
    cv::Mat row = image.clone();
    ResampleRow(row.ptr(0), taps, row.ptr(0));
    EXPECT_TRUE(std::equal(apart.begin(), apart.end(), row.ptr(0)));
  });
}

TEST(RowResample, RepeatsExactlyThirtyTwoTimesAround) {
  const ResampleTaps taps(640, 448);
  for (int x = 0; x + 14 < 448; ++x) {
    EXPECT_EQ(taps.index[x + 14], taps.index[x] + 20);
    EXPECT_EQ(taps.weight[x + 14], taps.weight[x]);
  }
}

TEST(RowResample, HalvingTakesTheRoundedMeanOfFour) {
  const cv::Mat image = RandomImage(2, 2 * 131, 4);
  ForEachDispatchTarget([&] {
    std::vector<uint8_t> out(131);
    HalveRows(image.ptr(0), image.ptr(1), 131, out.data());
    for (int x = 0; x < 131; ++x) {
      const int sum = image.at<uint8_t>(0, 2 * x) + image.at<uint8_t>(0, 2 * x + 1) +
                      image.at<uint8_t>(1, 2 * x) + image.at<uint8_t>(1, 2 * x + 1);
      ASSERT_EQ(out[x], (sum + 2) / 4) << x;
    }
  });
}

TEST(Blur, IsAGaussianOfTwoPixels) {
  const int width = 75;
  const int height = 20;
  const cv::Mat image = RandomImage(height + 6, width + 6, 5);
  double weights[7];
  double total = 0;
  for (int i = 0; i < 7; ++i) total += weights[i] = std::exp(-(i - 3) * (i - 3) / 8.0);
  ForEachDispatchTarget([&] {
    cv::Mat out(height, width, CV_8U);
    BlurImage(image.ptr(3) + 3, static_cast<ptrdiff_t>(image.step), width, height, out.data,
              static_cast<ptrdiff_t>(out.step));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int j = 0; j < 7; ++j) {
          for (int i = 0; i < 7; ++i) {
            sum += weights[j] * weights[i] / (total * total) * image.at<uint8_t>(y + j, x + i);
          }
        }
        // Two roundings, and weights in fixed point.
        ASSERT_NEAR(out.at<uint8_t>(y, x), sum, 2.0) << x << ' ' << y;
      }
    }
  });
}

Descriptor RandomDescriptor(std::mt19937_64* random) {
  return {(*random)(), (*random)(), (*random)(), (*random)()};
}

TEST(Hamming, CountsDifferingBits) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Descriptor a = RandomDescriptor(&random);
    const Descriptor b = RandomDescriptor(&random);
    int expected = 0;
    for (int bit = 0; bit < 256; ++bit) {
      expected += ((a[bit / 64] ^ b[bit / 64]) >> (bit % 64)) & 1;
    }
    ForEachDispatchTarget([&] { ASSERT_EQ(HammingDistance(a, b), expected); });
  }
}

TEST(Hamming, NearestTwoAreThoseOfASortedList) {
  std::mt19937_64 random(2);
  std::vector<Descriptor> descriptors(100);
  for (Descriptor& d : descriptors) d = RandomDescriptor(&random);
  std::vector<int> candidates = {5, 90, 17, 33, 2, 61, 78};
  const Descriptor query = RandomDescriptor(&random);
  std::vector<int> sorted = candidates;
  std::stable_sort(sorted.begin(), sorted.end(), [&](int i, int j) {
    return HammingDistance(query, descriptors[i]) < HammingDistance(query, descriptors[j]);
  });
  ForEachDispatchTarget([&] {
    const NearestTwo nearest = FindNearestTwo(query, descriptors, candidates);
    EXPECT_EQ(nearest.best_index, sorted[0]);
    EXPECT_EQ(nearest.second_index, sorted[1]);
    EXPECT_EQ(nearest.best_distance, HammingDistance(query, descriptors[sorted[0]]));
    EXPECT_EQ(nearest.second_distance, HammingDistance(query, descriptors[sorted[1]]));
    EXPECT_EQ(FindNearestTwo(query, descriptors, {}).best_index, -1);
    std::vector<uint16_t> all(descriptors.size());
    HammingDistances(query, descriptors, all);
    for (size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(all[i], HammingDistance(query, descriptors[i]));
    }
  });
}

TEST(EpipolarScan, FindsExactlyTheBearingsOnTheArc) {
  RandomGeometry random(5);
  std::vector<Eigen::Vector3d> bearings;
  std::vector<double> sigmas;
  const Eigen::Vector3d crowded = random.Bearing();
  for (int i = 0; i < 1003; ++i) {
    bearings.push_back(i % 3 != 0 ? random.Bearing() : random.Noisy(crowded, 0.3));
    sigmas.push_back(random.Uniform(0.01, 0.03));
  }
  const BearingColumns columns(bearings, sigmas);
  for (int trial = 0; trial < 100; ++trial) {
    EpipolarArc arc;
    arc.infinity = trial % 2 != 0 ? random.Bearing() : random.Noisy(crowded, 0.5);
    arc.epipole = random.Bearing();
    arc.normal = arc.infinity.cross(arc.epipole).normalized();
    arc.variance = 1e-4;
    const bool is_wide = trial % 5 == 0;  // most of a half of the sphere
    arc.max_sigmas = is_wide ? 35.0 : 3.0;
    arc.max_parallax = is_wide ? 1.5 : 1.2;
    arc.max_epipole_cosine = std::cos(0.05);
    // Distances from every threshold; those within rounding of one are not judged.
    constexpr double kRounding = 1e-5;
    std::vector<int> certain;
    std::vector<int> possible;
    const Eigen::Vector3d along =
        (arc.epipole - arc.epipole.dot(arc.infinity) * arc.infinity).normalized();
    for (size_t i = 0; i < bearings.size(); ++i) {
      const double both = std::sqrt(arc.variance + sigmas[i] * sigmas[i]);
      const double margin =
          std::min({arc.max_sigmas * both - std::abs(arc.normal.dot(bearings[i])),
                    along.dot(bearings[i]) + both,
                    arc.infinity.dot(bearings[i]) - std::cos(arc.max_parallax),
                    arc.max_epipole_cosine - std::abs(arc.epipole.dot(bearings[i]))});
      if (margin > kRounding) certain.push_back(static_cast<int>(i));
      if (margin > -kRounding) possible.push_back(static_cast<int>(i));
    }
    ForEachDispatchTarget([&] {
      std::vector<int> found;
      FindOnArc(columns, arc, &found);
      std::sort(found.begin(), found.end());
      EXPECT_TRUE(std::includes(found.begin(), found.end(), certain.begin(), certain.end()));
      EXPECT_TRUE(std::includes(possible.begin(), possible.end(), found.begin(), found.end()));
    });
  }
}

}  // namespace
}  // namespace orb360
