// Feature extraction at 2048 x 1024 with 2,000 features, beside OpenCV's ORB on the same image,
// and brute-force matching beside cv::BFMatcher.
#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "slam/features/matching.h"
#include "slam/features/orb_extractor.h"
#include "tests/slam/features/sphere_texture.h"

namespace orb360 {
namespace {

const cv::Mat& Image() {
  static const EquirectangularCamera kCamera(2048, 1024);
  static const cv::Mat kImage = SphereTexture(5, 2.0 * kCamera.AngleOfPixels(1.0))
                                    .Render(kCamera, Eigen::Quaterniond::Identity(), 2.0);
  return kImage;
}

void ExtractOrb360(benchmark::State& state) {
  OrbExtractor extractor{OrbOptions()};
  const cv::Mat& image = Image();  // rendered here, not while the clock runs
  int count = 0;
  for (auto _ : state) count = extractor.Extract(image).size();
  state.counters["features"] = count;
}
BENCHMARK(ExtractOrb360)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void ExtractOpenCv(benchmark::State& state) {
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(2000);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  const cv::Mat& image = Image();
  for (auto _ : state) orb->detectAndCompute(image, {}, keypoints, descriptors);
  state.counters["features"] = static_cast<double>(keypoints.size());
}
BENCHMARK(ExtractOpenCv)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void MatchMutuallyOrb360(benchmark::State& state) {
  OrbExtractor extractor{OrbOptions()};
  const Features features = extractor.Extract(Image());
  for (auto _ : state) {
    benchmark::DoNotOptimize(MatchMutually(features.descriptors, features.descriptors, {}));
  }
}
BENCHMARK(MatchMutuallyOrb360)->Unit(benchmark::kMillisecond)->UseRealTime();

void MatchMutuallyOpenCv(benchmark::State& state) {
  OrbExtractor extractor{OrbOptions()};
  Features features = extractor.Extract(Image());
  const cv::Mat rows(features.size(), 32, CV_8U, features.descriptors.data());
  const cv::BFMatcher matcher(cv::NORM_HAMMING, /*crossCheck=*/true);
  std::vector<cv::DMatch> matches;
  for (auto _ : state) matcher.match(rows, rows, matches);
}
BENCHMARK(MatchMutuallyOpenCv)->Unit(benchmark::kMillisecond)->UseRealTime();

void MatchNearbyOrb360(benchmark::State& state) {
  OrbExtractor extractor{OrbOptions()};
  const Features features = extractor.Extract(Image());
  for (auto _ : state) benchmark::DoNotOptimize(MatchNearby(features, features, 0.1, {}));
}
BENCHMARK(MatchNearbyOrb360)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace orb360
