// How well two images of the ground tell the length of a step: measured against true poses and
// depth.
//
//   ground_sweep_accuracy SEQUENCE [GAP]
//
// For each frame of a sequence folder with true depth and the frame GAP after it [1]: the true
// ratio of the step to the height over the ground, the measured one, the error of its logarithm and
// that in standard deviations, and the error of the rotation about the vertical; at the end their
// summary, the true height of the camera over the ground, and the distance between the two lenses
// that all pairs together show.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/slam/sequence_folder.h"
#include "nn/base/statistics.h"
#include "slam/features/sphere_pyramid.h"
#include "slam/scale/ground_sweep.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/io/depth_image.h>
#include <orb360/slam/io/trajectory.h>

namespace {

namespace fs = std::filesystem;
using orb360::Rigid3;

orb360::SpherePyramid ReadPyramid(const fs::path& sequence, int index) {
  orb360::SpherePyramid pyramid;
  orb360::BuildSpherePyramid(orb360::ReadGray(sequence, index), 8, &pyramid);
  return pyramid;
}

/// Height of the point half-way over the ground below it, within a fifth of the height; 0 where
/// there is no depth. `step` is the motion and `up` the normal, camera frame.
double TrueHeight(const cv::Mat& range, const Eigen::Vector3d& step, const Eigen::Vector3d& up) {
  const orb360::EquirectangularCamera camera(range.cols, range.rows);
  const Eigen::Vector3d forward = step.normalized();
  const Eigen::Vector3d normal = (up - forward.dot(up) * forward).normalized();
  std::vector<double> heights;
  for (int row = range.rows / 2; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const Eigen::Vector3d point =
          camera.BackProject({column + 0.5, row + 0.5}, range.at<float>(row, column));
      const double height = -normal.dot(point);
      const Eigen::Vector3d off = point + height * normal - 0.5 * step;
      if (height > 0 && off.norm() < 0.2 * height) heights.push_back(height);
    }
  }
  return heights.empty() ? 0.0 : orb360::Median(heights);
}

/// The absolute errors of one quantity, and the same in standard deviations.
struct Errors {
  std::vector<double> absolute;
  std::vector<double> normalized;

  void Add(double error, double sigma) {
    absolute.push_back(std::abs(error));
    normalized.push_back(std::abs(error) / sigma);
  }

  void Print(const char* name) {  // Reorders them.
    using orb360::NearestRankQuantile;
    std::printf(
        "%s: |error| median %.4f, 90 %% %.4f, largest %.4f; in sigmas 68 %% %.2f, 95 %% %.2f\n",
        name, orb360::Median(absolute), NearestRankQuantile(absolute, 0.9),
        NearestRankQuantile(absolute, 1.0), NearestRankQuantile(normalized, 0.68),
        NearestRankQuantile(normalized, 0.95));
  }
};

/// Prints the table of one sequence folder.
void Measure(const fs::path& sequence, int gap) {
  const std::vector<orb360::StampedPose> poses =
      orb360::ReadTrajectory(sequence / "groundtruth.txt");
  Errors lengths;
  Errors turns;
  std::vector<double> heights;  // true ones, metres
  double lens_information = 0;  // of the distance between the lenses, 1 / heights^2
  double weighted_lens_distance = 0;
  int num_frames = 0;
  std::printf("%6s %7s %8s %7s %7s %6s %7s %7s %6s %6s %6s\n", "frame", "true", "measured", "error",
              "sigma", "error/", "turn", "sigma", "corr.", "rival", "tiles");
  for (int i = 0; i + gap < static_cast<int>(poses.size()); ++i) {
    const fs::path depth = sequence / "depth" / orb360::NameOfFrame(i, "png");
    if (!fs::exists(depth)) continue;
    ++num_frames;
    const Rigid3 pose1 = poses[i].world_from_camera;
    const Rigid3 motion = pose1.Inverse() * poses[i + gap].world_from_camera;
    const Eigen::Vector3d up = pose1.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const double height = TrueHeight(orb360::ReadDepthImage(depth), motion.translation, up);
    const double truth = height > 0 ? motion.translation.norm() / height : 0.0;
    if (height > 0) heights.push_back(height);
    const auto step = orb360::MeasureGroundStep(ReadPyramid(sequence, i),
                                                ReadPyramid(sequence, i + gap), motion, up, {}, {});
    if (!step) {
      std::printf("%6d %7.4f %8s\n", i, truth, "-");
      continue;
    }
    const double error = std::log(step->ratio / truth);
    lengths.Add(error, step->sigma);
    turns.Add(step->turn, step->turn_sigma);  // The rotation given is the true one.
    if (const auto& [distance, sigma] = step->lens_distance; sigma > 0) {
      lens_information += 1 / (sigma * sigma);
      weighted_lens_distance += distance / (sigma * sigma);
    }
    std::printf("%6d %7.4f %8.4f %7.4f %7.4f %6.1f %7.4f %7.4f %6.2f %6.2f %6d\n", i, truth,
                step->ratio, error, step->sigma, error / step->sigma, step->turn, step->turn_sigma,
                step->correlation, step->rival, step->num_tiles);
  }
  if (!heights.empty()) {
    const auto [least, largest] = std::minmax_element(heights.begin(), heights.end());
    std::printf("true height of the camera: %.2f to %.2f m, ", *least, *largest);
    std::printf("median %.2f m\n", orb360::Median(heights));
  }
  if (lengths.absolute.empty()) return;
  std::printf("measured %zu of %d\n", lengths.absolute.size(), num_frames);
  lengths.Print("ln(step)");
  turns.Print("turn, rad");
  if (lens_information > 0) {
    std::printf("distance of the lenses, heights: %.4f, standard deviation %.4f\n",
                weighted_lens_distance / lens_information, 1 / std::sqrt(lens_information));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool wants_help = argc == 2 && std::string(argv[1]) == "--help";
  const int gap = argc == 3 ? std::atoi(argv[2]) : 1;
  if (wants_help || argc < 2 || argc > 3 || gap < 1) {
    std::fprintf(
        wants_help ? stdout : stderr,
        "usage: ground_sweep_accuracy SEQUENCE [GAP]\n"
        "SEQUENCE: folder with rgb/, depth/ and groundtruth.txt; GAP: frames, at least 1\n");
    return wants_help ? 0 : 2;
  }
  try {
    Measure(argv[1], gap);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ground_sweep_accuracy: %s\n", error.what());
    return 1;
  }
  return 0;
}
