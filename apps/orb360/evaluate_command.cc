#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/orb360/commands.h"
#include "apps/orb360/depth_report.h"
#include "apps/orb360/evaluation_report.h"
#include "slam/evaluation/cloud_folder.h"
#include "slam/evaluation/depth_folder.h"
#include "slam/evaluation/local_scale.h"
#include "slam/evaluation/revisit.h"
#include "slam/evaluation/scale_calibration.h"
#include "slam/evaluation/trajectory_error.h"
#include "slam/evaluation/trajectory_plot.h"
#include "slam/io/atomic_file.h"
#include "slam/io/dataset.h"
#include "slam/io/json_text.h"
#include "slam/io/ply.h"
#include "slam/io/scale_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

struct EvaluateOptions {
  std::string groundtruth;
  std::string estimate;
  double max_difference = 0.02;  // seconds
  bool prints_json = false;
  std::string plot;
};

/// Returns the trajectory file that `path` names: `path` itself, or `file_name` in it if it is a
/// folder.
std::filesystem::path TrajectoryFile(const std::filesystem::path& path, const char* file_name) {
  if (!std::filesystem::exists(path)) throw UserError(path.string() + ": no such file or folder");
  return std::filesystem::is_directory(path) ? path / file_name : path;
}

/// Returns the summary of the run that made the estimate; null where it cannot be read.
nlohmann::json RunSummary(const std::filesystem::path& estimate) {
  std::ifstream file(estimate / "summary.json");
  return file ? nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false) : nlohmann::json();
}

/// Adds the fraction of the frames that have a pose according to the summary of the run, or without
/// a summary the fraction of the true poses that are paired; and the figures that only the summary
/// contains.
void AddRunFigures(const std::filesystem::path& estimate, double paired_fraction,
                   nlohmann::json* report) {
  const nlohmann::json summary = RunSummary(estimate);
  if (!summary.is_object() || summary.value("frames", 0) <= 0) {
    (*report)["tracked_fraction"] = paired_fraction;
    return;
  }
  (*report)["tracked_fraction"] = summary.value("tracked", 0.0) / summary.value("frames", 0.0);
  for (const char* key : {"features_per_keyframe", "landmarks_per_keyframe"}) {
    (*report)[key] = summary.value(key, 0.0);
  }
}

/// Returns the times at which the run continued in another map according to its summary. None where
/// there is no summary, or one of an earlier version.
std::vector<double> MapChanges(const std::filesystem::path& estimate) {
  const nlohmann::json summary = RunSummary(estimate);
  std::vector<double> times;
  if (!summary.is_object() || !summary.contains("map_changes")) return times;
  for (const nlohmann::json& time : summary["map_changes"]) {
    if (!time.is_number()) {
      throw UserError((estimate / "summary.json").string() + ": `map_changes` holds something " +
                      "else than seconds; run the sequence again");
    }
    times.push_back(time.get<double>());
  }
  return times;
}

/// Compares the scale that the run states, of the whole and along the path, with the true one.
void AddStatedScale(const std::filesystem::path& estimate,
                    const std::optional<LocalScale>& local_scale, nlohmann::json* report) {
  const nlohmann::json summary = RunSummary(estimate);
  if (!summary.is_object() || !summary.contains("scale")) return;
  const nlohmann::json& scale = summary["scale"];
  if (!scale.is_object() || !scale.contains("state")) return;  // of an earlier version
  nlohmann::json stated = {{"state", scale["state"]}, {"value", nullptr}, {"sigma", nullptr}};
  const auto number = [&](const char* key) {
    const auto found = scale.find(key);
    return found != scale.end() && found->is_number() ? found->get<double>() : 0.0;
  };
  const double value = number("value");
  const double sigma = number("sigma");
  if (value > 0 && sigma > 0) {
    stated["value"] = value;
    stated["sigma"] = sigma;
    stated["error_sigmas"] = std::log((*report)["scale_factor"].get<double>() / value) / sigma;
  }
  const std::filesystem::path along_path = estimate / "scale.txt";
  if (local_scale && std::filesystem::exists(along_path)) {
    if (const auto calibration = CalibrateScale(*local_scale, ReadScales(along_path))) {
      stated["local"] = ToJson(*calibration);
    }
  }
  (*report)["stated_scale"] = std::move(stated);
}

/// Compares the loops that the run has closed, according to its summary, with the true ones.
void AddLoopErrors(const EvaluateOptions& options, const std::vector<StampedPose>& truth,
                   nlohmann::json* report) {
  const nlohmann::json summary = RunSummary(options.estimate);
  if (!summary.is_object() || !summary.contains("loop_times")) return;
  std::vector<LoopTimes> loops;
  for (const nlohmann::json& pair : summary["loop_times"]) {
    if (!pair.is_array() || pair.size() != 2 || !pair[0].is_number() || !pair[1].is_number()) {
      throw UserError(options.estimate + "/summary.json: `loop_times` holds something else than " +
                      "pairs of seconds; run the sequence again");
    }
    loops.push_back({pair[0].get<double>(), pair[1].get<double>()});
  }
  (*report)["loops"] = ToJson(CompareLoops(truth, loops));
}

/// Adds depth errors where both folders contain depth images of the same frames.
void AddDepthErrors(const std::filesystem::path& truth, const std::filesystem::path& estimate,
                    nlohmann::json* report) {
  const std::filesystem::path true_images = truth / Dataset::kDepthName;
  const std::filesystem::path images = estimate / Dataset::kDepthName;
  if (!std::filesystem::is_directory(true_images) || !std::filesystem::is_directory(images)) return;
  const DepthFolderErrors depth = CompareDepthFolders(
      true_images, images, estimate / Dataset::kConfidenceName, estimate / Dataset::kSourceName);
  if (!depth.images.empty()) (*report)["depth"] = ToJson(depth);
}

/// Adds errors of the dense cloud where the estimate has one and the truth has depth images.
void AddCloudErrors(const EvaluateOptions& options, const std::vector<StampedPose>& truth,
                    const std::vector<PosePair>& pairs, nlohmann::json* report) {
  const std::filesystem::path cloud = std::filesystem::path(options.estimate) / "cloud.ply";
  const std::filesystem::path sequence = options.groundtruth;
  if (!IsSurfacePly(cloud) || !std::filesystem::is_directory(sequence / Dataset::kDepthName)) {
    return;
  }
  const int num_threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  (*report)["cloud"] = ToJson(CompareCloudFile(cloud, sequence, truth, pairs, num_threads));
}

int Evaluate(const EvaluateOptions& options) {
  const std::vector<StampedPose> truth =
      ReadTrajectory(TrajectoryFile(options.groundtruth, Dataset::kGroundTruthName));
  const std::vector<StampedPose> estimate =
      ReadTrajectory(TrajectoryFile(options.estimate, "trajectory.txt"));
  const std::vector<PosePair> pairs = PairPoses(truth, estimate, options.max_difference);
  const std::optional<TrajectoryErrors> errors = EvaluateTrajectory(pairs);
  if (!errors) {
    throw UserError(options.estimate + ": cannot be aligned with " + options.groundtruth + ": " +
                    std::to_string(pairs.size()) + " of its " + std::to_string(estimate.size()) +
                    " poses have a time in common, and at least three different ones are needed");
  }

  const std::optional<LocalScale> local_scale =
      MeasureLocalScale(truth, pairs, MapChanges(options.estimate));
  nlohmann::json report = ToJson(*errors);
  report["local_scale"] = ToJson(local_scale);
  AddRunFigures(options.estimate,
                static_cast<double>(pairs.size()) / static_cast<double>(truth.size()), &report);
  AddStatedScale(options.estimate, local_scale, &report);
  AddLoopErrors(options, truth, &report);
  AddDepthErrors(options.groundtruth, options.estimate, &report);
  AddCloudErrors(options, truth, pairs, &report);
  if (!options.plot.empty()) {
    WriteFileAtomically(options.plot, PlotTrajectory(truth, pairs, *errors, local_scale));
  }
  if (options.prints_json) {
    std::cout << ToJsonText(report, 2) << '\n';
  } else {
    PrintReport(report, std::cout);
  }
  return EXIT_SUCCESS;
}

}  // namespace

void AddEvaluateCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand("evaluate", "Compare a trajectory with ground truth");
  const auto options = std::make_shared<EvaluateOptions>();
  command->add_option("GROUNDTRUTH", options->groundtruth, "Sequence folder or TUM trajectory")
      ->required();
  command->add_option("ESTIMATE", options->estimate, "Folder of `orb360 run` or TUM trajectory")
      ->required();
  command->add_flag("--json", options->prints_json, "Print JSON instead of a table");
  command
      ->add_option("--plot", options->plot,
                   "Also draw both trajectories, the error and the local scale (SVG)")
      ->type_name("FILE");
  command
      ->add_option("--max-difference", options->max_difference,
                   "Largest difference of two times that belong together, seconds")
      ->check(CLI::Range(0.0, 1e6))
      ->check(kIsNumber)
      ->type_name("S")
      ->capture_default_str();
  command->callback([options, chosen] { *chosen = [options] { return Evaluate(*options); }; });
}

}  // namespace orb360
