// Learns the pairs of points that descriptors compare (slam/features/comparison_pattern.cc), from
// panoramas given on the command line:
//   learn_pattern IMAGE... > pairs.txt
//
// After Rublee et al. (ORB, ICCV 2011): turned by their orientation, patches are much alike, and
// random comparisons are biased and say the same thing over and over. Of many candidate pairs those
// are taken whose outcome differs most between patches and least between two views of one patch,
// as long as they are not correlated with those already taken. Two views: the panorama and the same
// sphere turned at random.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/features/orb_extractor.h"
#include "slam/features/sphere_pyramid.h"
#include "slam/features/tangent_sampling.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

constexpr int kReach = static_cast<int>(TangentSampling::kMaxRadius);
constexpr int kSide = 2 * kReach + 1;
constexpr int kPairs = 256;

using Patch = std::vector<uint8_t>;  // kSide x kSide, east along the rows, turned upright
struct View {
  std::vector<Patch> patches;
  Features features;
};
struct Pair {
  int first;  // indices into a patch
  int second;
};
using Bits = std::vector<uint64_t>;  // by patch

cv::Mat Turn(const cv::Mat& image, const Eigen::Quaterniond& image_from_turned) {
  const EquirectangularCamera camera(image.cols, image.rows);
  cv::Mat map(image.size(), CV_32FC2);
  for (int v = 0; v < map.rows; ++v) {
    for (int u = 0; u < map.cols; ++u) {
      const Eigen::Vector2d p =
          camera.Project(image_from_turned * camera.Bearing({u + 0.5, v + 0.5}));
      map.at<cv::Vec2f>(v, u) = {static_cast<float>(p.x() - 0.5), static_cast<float>(p.y() - 0.5)};
    }
  }
  cv::Mat turned;
  cv::remap(image, turned, map, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_WRAP);
  return turned;
}

// Features and their patches; away from the poles, where the plain level is as good as any.
View Describe(const cv::Mat& image) {
  constexpr double kMaxHeight = 0.8;  // sine of the latitude
  OrbExtractor extractor({.num_features = image.cols});
  View view;
  view.features = extractor.Extract(image);
  std::vector<PyramidLevel> levels;
  BuildSpherePyramid(image, 8, &levels);
  for (PyramidLevel& level : levels) {
    cv::GaussianBlur(level.padded.clone(), level.padded, cv::Size(7, 7), 2.0);
  }
  for (int i = 0; i < view.features.size(); ++i) {
    const Keypoint& keypoint = view.features.keypoints[i];
    const Eigen::Vector3d& bearing = view.features.bearings[i];
    Patch patch;
    if (std::abs(bearing.z()) < kMaxHeight) {
      const EquirectangularCamera& camera = levels[keypoint.level].camera;
      const cv::Mat level = levels[keypoint.level].image();
      const Eigen::Vector3d south = (bearing.z() * bearing - Eigen::Vector3d::UnitZ()).normalized();
      const Eigen::Vector3d east = south.cross(bearing);
      const double k = camera.AngleOfPixels(1.0);
      const double c = std::cos(keypoint.angle);
      const double s = std::sin(keypoint.angle);
      for (int y = -kReach; y <= kReach; ++y) {
        for (int x = -kReach; x <= kReach; ++x) {
          const Eigen::Vector2d p =
              camera.Project(bearing + k * (c * x - s * y) * east + k * (s * x + c * y) * south);
          patch.push_back(level.at<uint8_t>(std::min(static_cast<int>(p.y()), level.rows - 1),
                                            static_cast<int>(p.x()) % level.cols));
        }
      }
    }
    view.patches.push_back(std::move(patch));
  }
  return view;
}

// Patches of corners found in both views, one after the other.
void Collect(const cv::Mat& image, const Eigen::Quaterniond& image_from_turned,
             std::vector<Patch>* first, std::vector<Patch>* second) {
  const View a = Describe(image);
  const View b = Describe(Turn(image, image_from_turned));
  std::vector<int> near;
  for (int i = 0; i < a.features.size(); ++i) {
    if (a.patches[i].empty()) continue;
    const Eigen::Vector3d bearing = image_from_turned.conjugate() * a.features.bearings[i];
    const Keypoint& keypoint = a.features.keypoints[i];
    const double limit = std::cos(2.0 * keypoint.sigma);
    near.clear();
    b.features.grid.Query(bearing, 2.0 * keypoint.sigma, &near);
    for (const int j : near) {
      if (b.patches[j].empty() || b.features.keypoints[j].level != keypoint.level ||
          b.features.bearings[j].dot(bearing) < limit) {
        continue;
      }
      first->push_back(a.patches[i]);
      second->push_back(b.patches[j]);
      break;
    }
  }
}

std::vector<Pair> DrawCandidates() {
  constexpr int kCandidates = 60000;
  constexpr int kMinSeparation = 3;  // pixels; nearer points are one after blurring
  std::mt19937 random(360);
  const auto draw = [&] {
    while (true) {
      const int x = static_cast<int>(random() % kSide) - kReach;
      const int y = static_cast<int>(random() % kSide) - kReach;
      if (x * x + y * y <= kReach * kReach) return Eigen::Vector2i(x, y);
    }
  };
  std::vector<Pair> pairs;
  while (pairs.size() < kCandidates) {
    const Eigen::Vector2i a = draw();
    const Eigen::Vector2i b = draw();
    if ((a - b).squaredNorm() < kMinSeparation * kMinSeparation) continue;
    const auto index = [](const Eigen::Vector2i& p) {
      return (p.y() + kReach) * kSide + p.x() + kReach;
    };
    pairs.push_back({index(a), index(b)});
  }
  return pairs;
}

Bits Compare(const std::vector<Patch>& patches, const Pair& pair) {
  Bits bits((patches.size() + 63) / 64, 0);
  for (size_t i = 0; i < patches.size(); ++i) {
    bits[i / 64] |= static_cast<uint64_t>(patches[i][pair.first] < patches[i][pair.second])
                    << (i % 64);
  }
  return bits;
}

int CountDifferent(const Bits& a, const Bits& b) {
  int count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += std::popcount(a[i] ^ b[i]);
  return count;
}

std::vector<Pair> Select(const std::vector<Patch>& first, const std::vector<Patch>& second) {
  struct Candidate {
    Pair pair;
    double quality;
    double mean;
    Bits bits;
  };
  const double n = static_cast<double>(first.size());
  const Bits none((first.size() + 63) / 64, 0);
  std::vector<Candidate> candidates;
  for (const Pair& pair : DrawCandidates()) {
    Bits bits = Compare(first, pair);
    const double mean = CountDifferent(bits, none) / n;
    const double flips = CountDifferent(bits, Compare(second, pair)) / n;
    // Two patches differ with probability 2 m (1 - m), two views of one with `flips`: how many
    // standard deviations these are apart.
    const double differs = 2.0 * mean * (1.0 - mean);
    const double spread = std::sqrt(differs * (1.0 - differs) + flips * (1.0 - flips));
    candidates.push_back({pair, (differs - flips) / std::max(spread, 1e-9), mean, std::move(bits)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.quality > b.quality; });
  const auto correlation = [&](const Candidate& a, const Candidate& b) {
    const double both = 0.5 * (a.mean + b.mean - CountDifferent(a.bits, b.bits) / n);
    return std::abs(both - a.mean * b.mean) /
           std::sqrt(a.mean * (1 - a.mean) * b.mean * (1 - b.mean) + 1e-12);
  };
  for (double limit = 0.2;; limit += 0.02) {
    std::vector<const Candidate*> taken;
    for (const Candidate& candidate : candidates) {
      if (candidate.quality <= 0) break;
      if (std::all_of(taken.begin(), taken.end(),
                      [&](const Candidate* t) { return correlation(*t, candidate) < limit; })) {
        taken.push_back(&candidate);
      }
      if (taken.size() < kPairs) continue;
      std::fprintf(stderr, "correlation below %.2f, quality from %.2f to %.2f\n", limit,
                   taken.front()->quality, taken.back()->quality);
      std::vector<Pair> pairs;
      pairs.reserve(taken.size());
      for (const Candidate* t : taken) pairs.push_back(t->pair);
      return pairs;
    }
  }
}

int Run(int argc, char** argv) {
  std::vector<Patch> first;
  std::vector<Patch> second;
  std::mt19937 random(1);
  for (int i = 1; i < argc; ++i) {
    const cv::Mat image = cv::imread(argv[i], cv::IMREAD_GRAYSCALE);
    if (image.empty()) {
      std::fprintf(stderr, "learn_pattern: cannot read %s\n", argv[i]);
      return EXIT_FAILURE;
    }
    const auto draw = [&] { return random() / 2147483648.0 - 1.0; };
    Collect(image, ExpSo3(Eigen::Vector3d(draw(), draw(), draw())), &first, &second);
  }
  std::fprintf(stderr, "%zu patches seen twice\n", first.size());
  if (first.empty()) return EXIT_FAILURE;
  constexpr int kPerLine = 4;
  int column = 0;
  for (const Pair& pair : Select(first, second)) {
    std::printf("{%d, %d, %d, %d},%s", pair.first % kSide - kReach, pair.first / kSide - kReach,
                pair.second % kSide - kReach, pair.second / kSide - kReach,
                ++column % kPerLine == 0 ? "\n" : " ");
  }
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace orb360

int main(int argc, char** argv) { return orb360::Run(argc, argv); }
