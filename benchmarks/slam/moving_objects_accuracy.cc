// What finding objects that move along with the camera does for depth: against true depth.
//
//   moving_objects_accuracy SEQUENCE RUN [--images DIR]
//
// RUN: folder of `orb360 run SEQUENCE --save-depth`. For its views with true depth: the mean
// relative error of ranges up to 80 m, weighted by solid angle, before and after objects are placed
// on the ground (slam/depth/moving_objects.h), and how much of what was changed became better.
// --images: writes the images with what was changed, green where it became better and red where it
// became worse.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "benchmarks/slam/run_views.h"
#include "benchmarks/slam/sequence_folder.h"
#include "slam/pipeline/view_depth.h"
#include "slam/pipeline/view_selection.h"
#include <orb360/slam/io/depth_image.h>

namespace {

namespace fs = std::filesystem;

constexpr float kConfidence = 0.97F;
constexpr double kMinError = 0.01;  // of ln(range)
constexpr float kMaxRange = 80.0F;  // metres

/// As before the second pass knew of confidences: each range counts.
std::vector<orb360::RunView> ReadViews(const fs::path& sequence, const fs::path& run) {
  std::vector<orb360::RunView> views = orb360::ReadRunViews(sequence, run, kMinError);
  for (orb360::RunView& view : views) {
    view.depth.confidence.setTo(kConfidence);
    view.depth.source.release();
    view.view = orb360::DepthView(view.depth, view.view.world_from_camera(), kMinError);
  }
  return views;
}

void Measure(const fs::path& sequence, const fs::path& run, const std::optional<fs::path>& images) {
  const std::vector<orb360::RunView> read = ReadViews(sequence, run);
  if (images) fs::create_directories(*images);
  std::vector<orb360::DenseView> views;
  std::vector<size_t> all;
  for (const orb360::RunView& view : read) {
    all.push_back(views.size());
    views.push_back({.frame_index = view.index,
                     .world_from_camera = view.view.world_from_camera(),
                     .neighbours = {}});
  }
  double sums[2] = {0, 0};
  double total = 0;
  double better = 0;
  double changed = 0;
  for (size_t i = 0; i < read.size(); ++i) {
    const fs::path file = sequence / "depth" / orb360::NameOfFrame(read[i].index, "png");
    if (!fs::exists(file)) continue;
    const cv::Mat truth = orb360::ReadDepthImage(file);
    const orb360::Rigid3& pose = views[i].world_from_camera;
    const auto ground =
        orb360::FindGround(read[i].depth, pose.rotation.inverse() * Eigen::Vector3d::UnitZ(), {});
    orb360::DenseDepth after = read[i].depth;
    after.range = after.range.clone();
    after.confidence = after.confidence.clone();
    int count = 0;
    if (ground) {
      const orb360::ViewCompletionOptions options;
      std::vector<double> distances = options.ground_distances;
      for (double& distance : distances) distance *= std::exp(ground->log_height);
      std::vector<const orb360::DepthView*> others;
      for (const size_t other :
           orb360::ChooseViewsByDistance(views, i, all, distances, options.max_distance_ratio)) {
        others.push_back(&read[other].view);
      }
      const auto objects =
          orb360::FindMovingObjects(orb360::FindBelowGround(read[i].view, *ground, options.objects),
                                    read[i].view, *ground, others, options.objects);
      orb360::PlaceOnGround(objects, *ground, options.objects, &after);
      count = static_cast<int>(objects.size());
    }
    cv::Mat shown;
    if (images) cv::cvtColor(orb360::ReadGray(sequence, read[i].index), shown, cv::COLOR_GRAY2BGR);
    double view_sums[2] = {0, 0};
    double view_total = 0;
    for (int row = 0; row < truth.rows; ++row) {
      const double weight = std::sin((row + 0.5) / truth.rows * std::numbers::pi);
      for (int column = 0; column < truth.cols; ++column) {
        const float t = truth.at<float>(row, column);
        if (!(t > 0 && t < kMaxRange)) continue;
        const double errors[2] = {std::abs(read[i].depth.range.at<float>(row, column) / t - 1.0),
                                  std::abs(after.range.at<float>(row, column) / t - 1.0)};
        view_total += weight;
        for (int k = 0; k < 2; ++k) view_sums[k] += weight * errors[k];
        if (errors[0] == errors[1]) continue;
        changed += weight;
        better += errors[1] < errors[0] ? weight : 0;
        if (!images) continue;
        shown.at<cv::Vec3b>(row, column) =
            errors[1] < errors[0] ? cv::Vec3b(0, 255, 0) : cv::Vec3b(0, 0, 255);
      }
    }
    for (int k = 0; k < 2; ++k) sums[k] += view_sums[k] / view_total;
    total += 1;
    if (count > 0) {
      std::printf("%06d: %d objects, error %.3f -> %.3f\n", read[i].index, count,
                  view_sums[0] / view_total, view_sums[1] / view_total);
    }
    if (images) cv::imwrite((*images / orb360::NameOfFrame(read[i].index, "png")).string(), shown);
  }
  if (!(total > 0)) throw std::runtime_error(run.string() + ": no view with true depth");
  std::printf(
      "relative error of %.0f views: %.4f -> %.4f; of what was changed %.0f %% became better\n",
      total, sums[0] / total, sums[1] / total, 100 * better / std::max(changed, 1e-9));
}

constexpr char kUsage[] =
    "usage: moving_objects_accuracy SEQUENCE RUN [--images DIR]\n"
    "SEQUENCE: folder with rgb/, depth/ and groundtruth.txt; RUN: folder of `orb360 run "
    "--save-depth`\n";

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool wants_help = arguments.size() == 1 && arguments[0] == "--help";
  const bool has_images = arguments.size() == 4 && arguments[2] == "--images";
  if (wants_help || (arguments.size() != 2 && !has_images)) {
    std::fputs(kUsage, wants_help ? stdout : stderr);
    return wants_help ? 0 : 2;
  }
  try {
    Measure(arguments[0], arguments[1],
            has_images ? std::optional<fs::path>(arguments[3]) : std::nullopt);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "moving_objects_accuracy: %s\n", error.what());
    return 1;
  }
  return 0;
}
