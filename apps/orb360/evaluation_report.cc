#include "apps/orb360/evaluation_report.h"

#include <cmath>
#include <iomanip>
#include <span>
#include <string>

#include "apps/orb360/depth_report.h"
#include "apps/orb360/report_row.h"

namespace orb360 {
namespace {

constexpr ReportRow kRows[] = {
    {"pairs", "pairs", "", 0},
    {"tracked_fraction", "tracked fraction", "%", 1, 100.0},
    {"features_per_keyframe", "features per keyframe", "", 1},
    {"landmarks_per_keyframe", "landmarks per keyframe", "", 1},
    {"scale_factor", "scale factor (1 is perfect)", "", 5},
    {"ate_rmse_se3", "ATE after rigid alignment, RMSE", "m", 4},
    {"ate_median_se3", "  median", "m", 4},
    {"ate_max_se3", "  largest", "m", 4},
    {"ate_rmse_sim3", "ATE after similarity alignment, RMSE", "m", 4},
    {"ate_median_sim3", "  median", "m", 4},
    {"ate_max_sim3", "  largest", "m", 4},
    {"rpe_piece_m", "RPE over pieces of the path, their length", "m", 1},
    {"rpe_trans_percent", "  translation, estimate scaled", "%", 4},
    {"rpe_raw_percent", "  translation, estimate as it is", "%", 4},
    {"rpe_rot_deg_per_m", "  rotation", "deg/m", 6},
    {"rpe_frame_trans_m", "RPE from frame to frame, translation", "m", 5},
    {"rpe_frame_rot_deg", "  rotation", "deg", 5},
};

/// The lines about the local scale.
constexpr ReportRow kLocalScaleRows[] = {
    {"window_m", "local scale, length of the windows", "m", 0},
    {"min", "  least (1 is perfect)", "", 5},
    {"max", "  largest", "", 5},
    {"drift_median_per_100m", "  drift in 100 m, median", "%", 2, 100.0},
    {"drift_worst_per_100m", "  largest", "%", 2, 100.0},
    {"worst_deviation_100m", "  largest error of the scale of 100 m", "%", 2, 100.0},
};

/// The lines about loops.
constexpr ReportRow kLoopRows[] = {
    {"revisits", "places that the camera comes back to", "", 0},
    {"closed", "  loops closed there", "", 0},
    {"wrong", "  wrong loops", "", 0},
};

/// The lines about the cloud.
constexpr ReportRow kCloudRows[] = {
    {"points", "cloud, points compared", "", 0},
    {"median_distance", "  median distance from the surface", "m", 3},
    {"accuracy_10cm", "  within 15 m: accuracy, nearer than 10 cm", "%", 1, 100.0},
    {"accuracy_25cm", "      25 cm", "%", 1, 100.0},
    {"completeness_10cm", "    completeness, nearer than 10 cm", "%", 1, 100.0},
    {"completeness_25cm", "      25 cm", "%", 1, 100.0},
    {"f_score_5cm", "    F-score of both, 5 cm", "", 3},
    {"f_score_10cm", "      10 cm", "", 3},
    {"f_score_25cm", "      25 cm", "", 3},
    {"f_score_1_percent", "  within 30 m: F-score, 1 % of the range", "", 3},
};

constexpr ReportRow kStatedScaleRows[] = {
    {"value", "stated scale", "", 4},
    {"sigma", "  its standard deviation", "%", 2, 100.0},
    {"error_sigmas", "  its error, standard deviations", "", 2},
};
constexpr ReportRow kCalibrationRows[] = {
    {"normalized_squared_error", "  along the path: normalized squared error", "", 2},
    {"within_1_sigma", "    within one standard deviation", "%", 1, 100.0},
    {"within_2_sigma", "    within two", "%", 1, 100.0},
};

constexpr int kLabelWidth = 44;
constexpr int kNumberWidth = 12;

void PrintRows(std::span<const ReportRow> rows, const nlohmann::json& report, std::ostream& out) {
  for (const ReportRow& row : rows) {
    if (!report.contains(row.key) || report[row.key].is_null()) continue;
    out << std::left << std::setw(kLabelWidth) << row.label << std::right << std::setw(kNumberWidth)
        << std::setprecision(row.decimals) << row.factor * report[row.key].get<double>() << ' '
        << row.unit << '\n';
  }
}

}  // namespace

nlohmann::json ToJson(const TrajectoryErrors& errors) {
  return {{"pairs", errors.position_errors.size()},
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

nlohmann::json ToJson(const CloudErrors& errors) {
  nlohmann::json json = {{"points", errors.points},
                         {"surfels", errors.surfels},
                         {"median_distance", errors.median_distance}};
  const auto add = [&json](const CloudAgreement& agreement, const std::string& distance) {
    json["accuracy_" + distance] = agreement.accuracy;
    json["completeness_" + distance] = agreement.completeness;
    json["f_score_" + distance] = agreement.f_score;
  };
  for (size_t i = 0; i < errors.within.size(); ++i) {
    add(errors.within[i], std::to_string(std::lround(100 * CloudErrors::kDistances[i])) + "cm");
  }
  add(errors.within_relative, "1_percent");
  return json;
}

nlohmann::json ToJson(const std::optional<LocalScale>& scale) {
  if (!scale) return nullptr;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  return {{"window_m", LocalScale::kWindow},
          {"windows", scale->windows.size()},
          {"min", scale->min},
          {"max", scale->max},
          {"drift_median_per_100m", or_null(scale->drift_median)},
          {"drift_worst_per_100m", or_null(scale->drift_worst)},
          {"worst_deviation_100m", or_null(scale->worst_deviation)}};
}

nlohmann::json ToJson(const ScaleCalibration& calibration) {
  return {{"windows", calibration.windows},
          {"normalized_squared_error", calibration.normalized_squared_error},
          {"within_1_sigma", calibration.within_1_sigma},
          {"within_2_sigma", calibration.within_2_sigma},
          {"largest_error_sigmas", calibration.largest}};
}

nlohmann::json ToJson(const LoopErrors& errors) {
  return {{"revisits", errors.revisits}, {"closed", errors.closed}, {"wrong", errors.wrong}};
}

void PrintReport(const nlohmann::json& report, std::ostream& out) {
  out << std::fixed;
  PrintRows(kRows, report, out);
  if (const nlohmann::json scale = report.value("local_scale", nlohmann::json());
      !scale.is_null()) {
    PrintRows(kLocalScaleRows, scale, out);
  }
  if (report.contains("stated_scale")) {
    PrintRows(kStatedScaleRows, report["stated_scale"], out);
    if (report["stated_scale"].contains("local")) {
      PrintRows(kCalibrationRows, report["stated_scale"]["local"], out);
    }
  }
  if (report.contains("loops")) PrintRows(kLoopRows, report["loops"], out);
  if (report.contains("cloud")) PrintRows(kCloudRows, report["cloud"], out);
  if (report.contains("depth")) PrintDepth(report["depth"], out);
}

}  // namespace orb360
