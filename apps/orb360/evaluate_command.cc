#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/orb360/commands.h"
#include "slam/check.h"
#include "slam/evaluation/plot.h"
#include "slam/evaluation/trajectory_error.h"
#include "slam/io/atomic_file.h"
#include "slam/io/dataset.h"
#include "slam/io/trajectory.h"

namespace orb360 {
namespace {

struct EvaluateOptions {
  std::string groundtruth;
  std::string estimate;
  double max_difference = 0.02;  // seconds
  bool prints_json = false;
  std::string plot;
};

/// The trajectory file that `path` names: itself, or `file_name` in the folder that it is.
std::filesystem::path TrajectoryFile(const std::filesystem::path& path, const char* file_name) {
  if (!std::filesystem::exists(path)) throw UserError(path.string() + ": no such file or folder");
  return std::filesystem::is_directory(path) ? path / file_name : path;
}

/// The summary of the run that made the estimate; null where there is none to read.
nlohmann::json RunSummary(const std::filesystem::path& estimate) {
  std::ifstream file(estimate / "summary.json");
  return file ? nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false) : nlohmann::json();
}

nlohmann::json ToJson(const TrajectoryErrors& errors, size_t pairs) {
  return {{"pairs", pairs},
          {"ate_rmse_se3", errors.ate_se3.rmse},
          {"ate_median_se3", errors.ate_se3.median},
          {"ate_mean_se3", errors.ate_se3.mean},
          {"ate_max_se3", errors.ate_se3.max},
          {"ate_rmse_sim3", errors.ate_sim3.rmse},
          {"ate_median_sim3", errors.ate_sim3.median},
          {"ate_mean_sim3", errors.ate_sim3.mean},
          {"ate_max_sim3", errors.ate_sim3.max},
          {"scale_factor", errors.truth_from_estimate.scale},
          {"rpe_trans_percent", errors.rpe.translation_percent},
          {"rpe_raw_percent", errors.rpe_raw.translation_percent},
          {"rpe_rot_deg_per_m", errors.rpe.rotation_deg_per_m},
          {"rpe_piece_m", errors.rpe.piece_length},
          {"rpe_pieces", errors.rpe.pieces},
          {"rpe_frame_trans_m", errors.rpe_frame.translation},
          {"rpe_frame_rot_deg", errors.rpe_frame.rotation_deg}};
}

void PrintRow(const std::string& label, double value, const std::string& unit, int decimals) {
  std::cout << std::left << std::setw(44) << label << std::right << std::setw(12) << std::fixed
            << std::setprecision(decimals) << value << ' ' << unit << '\n';
}

void PrintTable(const TrajectoryErrors& errors, const nlohmann::json& json) {
  PrintRow("pairs", json["pairs"], "", 0);
  PrintRow("tracked share", 100.0 * json["tracked_share"].get<double>(), "%", 1);
  if (json.contains("features_per_keyframe")) {
    PrintRow("features per keyframe", json["features_per_keyframe"], "", 1);
  }
  PrintRow("scale factor (1 is perfect)", errors.truth_from_estimate.scale, "", 5);
  PrintRow("ATE after rigid alignment, RMSE", errors.ate_se3.rmse, "m", 4);
  PrintRow("  median", errors.ate_se3.median, "m", 4);
  PrintRow("  largest", errors.ate_se3.max, "m", 4);
  PrintRow("ATE after similarity alignment, RMSE", errors.ate_sim3.rmse, "m", 4);
  PrintRow("  median", errors.ate_sim3.median, "m", 4);
  PrintRow("  largest", errors.ate_sim3.max, "m", 4);
  PrintRow("RPE over pieces of the path, their length", errors.rpe.piece_length, "m", 1);
  PrintRow("  translation, estimate scaled", errors.rpe.translation_percent, "%", 4);
  PrintRow("  translation, estimate as it is", errors.rpe_raw.translation_percent, "%", 4);
  PrintRow("  rotation", errors.rpe.rotation_deg_per_m, "deg/m", 6);
  PrintRow("RPE from frame to frame, translation", errors.rpe_frame.translation, "m", 5);
  PrintRow("  rotation", errors.rpe_frame.rotation_deg, "deg", 5);
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

  nlohmann::json json = ToJson(*errors, pairs.size());
  const nlohmann::json summary = RunSummary(options.estimate);
  if (summary.is_object() && summary.value("frames", 0) > 0) {
    json["tracked_share"] = summary.value("tracked", 0.0) / summary["frames"].get<double>();
    json["features_per_keyframe"] = summary.value("features_per_keyframe", 0.0);
  } else {
    json["tracked_share"] = static_cast<double>(pairs.size()) / static_cast<double>(truth.size());
  }
  if (!options.plot.empty()) {
    WriteFileAtomically(options.plot, PlotTrajectory(truth, pairs, *errors));
  }
  if (options.prints_json) {
    std::cout << json.dump(2) << '\n';
  } else {
    PrintTable(*errors, json);
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
  command->add_option("--plot", options->plot, "Also draw both trajectories and the error (SVG)")
      ->type_name("FILE");
  command
      ->add_option("--max-difference", options->max_difference,
                   "Largest difference of two times that belong together, seconds")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S")
      ->capture_default_str();
  command->callback([options, chosen] { *chosen = [options] { return Evaluate(*options); }; });
}

}  // namespace orb360
