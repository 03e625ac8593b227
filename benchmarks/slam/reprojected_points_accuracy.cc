// How many of the points that a view gets from other views are right, by how different the colours
// of both may be: against true depth.
//
//   reprojected_points_accuracy SEQUENCE RUN
//
// RUN: folder of `orb360 run SEQUENCE --save-depth`. For its views with true depth: the points of
// slam/depth/reprojected_points.h, where this view has measured nothing, with several values of
// max_color_difference. Right: within 20 % of the truth, up to 80 m.

#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "benchmarks/slam/run_views.h"
#include "benchmarks/slam/sequence_folder.h"
#include "slam/depth/reprojected_points.h"
#include "slam/pipeline/view_depth.h"
#include "slam/pipeline/view_ranges.h"
#include "slam/pipeline/view_selection.h"

namespace {

namespace fs = std::filesystem;

constexpr double kMinError = 0.01;  // of ln(range), as in the second pass
constexpr float kMaxRange = 80.0F;  // metres
constexpr float kMaxOff = 0.2F;     // of a right point, relative
constexpr double kDifferences[] = {
    std::numeric_limits<double>::infinity(), 1.0, 0.7, 0.5, 0.4, 0.3, 0.2};

struct Count {
  int right = 0;
  int nearer = 0;  ///< Than the truth, or before the sky.
  int farther = 0;
};

void Add(const cv::Mat& range, const cv::Mat& truth, Count* count) {
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const float r = range.at<float>(row, column);
      const float t = truth.at<float>(row, column);
      if (!(r > 0) || t > kMaxRange) continue;
      if (t > 0 && std::abs(r / t - 1) <= kMaxOff) {
        ++count->right;
      } else {
        ++(t > 0 && r > t ? count->farther : count->nearer);
      }
    }
  }
}

void Measure(const fs::path& sequence, const fs::path& run) {
  const std::vector<orb360::RunView> read = orb360::ReadRunViews(sequence, run, kMinError);
  const orb360::ViewDepthOptions options;
  std::vector<orb360::DenseView> views;
  std::vector<cv::Mat> colors;
  std::vector<size_t> all;
  for (const orb360::RunView& view : read) {
    all.push_back(views.size());
    views.push_back({.frame_index = view.index,
                     .world_from_camera = view.view.world_from_camera(),
                     .neighbours = {}});
    colors.push_back(
        orb360::SurfaceColors(orb360::ReadColor(sequence, view.index), view.depth.range.size()));
  }
  std::vector<Count> counts(std::size(kDifferences));
  int num_views = 0;
  for (size_t i = 0; i < read.size(); ++i) {
    const fs::path file = sequence / "depth" / orb360::NameOfFrame(read[i].index, "png");
    if (!fs::exists(file)) continue;
    const cv::Mat truth = orb360::ReadDepthImage(file);
    const cv::Size size = read[i].depth.range.size();
    if (truth.size() != size) throw std::runtime_error(file.string() + ": of another size");
    ++num_views;
    std::vector<double> distances = options.second.distances;
    const double range = orb360::TrustedRange(read[i].depth, options.min_trusted_confidence);
    for (double& distance : distances) distance *= range;
    std::vector<orb360::SeenView> others;
    for (const size_t other : orb360::ChooseViewsByDistance(views, i, all, distances,
                                                            options.second.max_distance_ratio)) {
      others.push_back({&read[other].view, &colors[other]});
    }
    orb360::SparseDepth measured{cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F)};
    orb360::SampleSquares(orb360::MeasuredOf(read[i].depth), options.sparse_spacing, 0,
                          options.sparse, &measured);
    for (size_t k = 0; k < counts.size(); ++k) {
      orb360::SparseDepth points{measured.range.clone(), measured.confidence.clone()};
      orb360::AddReprojectedPoints(views[i].world_from_camera, colors[i], others,
                                   {.spacing = options.sparse_spacing,
                                    .max_color_difference = kDifferences[k],
                                    .sparse = options.sparse},
                                   &points);
      points.range.setTo(0, measured.range > 0);
      Add(points.range, truth, &counts[k]);
    }
  }
  if (num_views == 0) throw std::runtime_error(run.string() + ": no view with true depth");
  std::printf("%d views\nlargest difference    right   nearer  farther\n", num_views);
  for (size_t k = 0; k < counts.size(); ++k) {
    std::printf("%18.1f %8d %8d %8d\n", kDifferences[k], counts[k].right, counts[k].nearer,
                counts[k].farther);
  }
}

constexpr char kUsage[] =
    "usage: reprojected_points_accuracy SEQUENCE RUN\n"
    "SEQUENCE: folder with rgb/, depth/ and groundtruth.txt; RUN: folder of `orb360 run "
    "--save-depth`\n";

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool wants_help = arguments.size() == 1 && arguments[0] == "--help";
  if (wants_help || arguments.size() != 2) {
    std::fputs(kUsage, wants_help ? stdout : stderr);
    return wants_help ? 0 : 2;
  }
  try {
    Measure(arguments[0], arguments[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "reprojected_points_accuracy: %s\n", error.what());
    return 1;
  }
  return 0;
}
