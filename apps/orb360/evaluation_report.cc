#include "apps/orb360/evaluation_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <span>
#include <sstream>
#include <string>

namespace orb360 {
namespace {

/// A line of the table, which describes a key of the report.
struct Row {
  const char* key;
  const char* label;
  const char* unit;
  int decimals;
  double factor = 1.0;  // from the unit of the report to that of the table
};

constexpr Row kRows[] = {
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
constexpr Row kLocalScaleRows[] = {
    {"window_m", "local scale, length of the windows", "m", 0},
    {"min", "  least (1 is perfect)", "", 5},
    {"max", "  largest", "", 5},
    {"drift_median_per_100m", "  drift in 100 m, median", "%", 2, 100.0},
    {"drift_worst_per_100m", "  largest", "%", 2, 100.0},
    {"worst_deviation_100m", "  largest error of the scale of 100 m", "%", 2, 100.0},
};

/// The lines about loops.
constexpr Row kLoopRows[] = {
    {"revisits", "places that the camera comes back to", "", 0},
    {"closed", "  loops closed there", "", 0},
    {"wrong", "  wrong loops", "", 0},
};

/// The lines about the cloud.
constexpr Row kCloudRows[] = {
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

constexpr Row kStatedScaleRows[] = {
    {"value", "stated scale", "", 4},
    {"sigma", "  its standard deviation", "%", 2, 100.0},
    {"error_sigmas", "  its error, standard deviations", "", 2},
};
constexpr Row kCalibrationRows[] = {
    {"normalized_squared_error", "  along the path: normalized squared error", "", 2},
    {"within_1_sigma", "    within one standard deviation", "%", 1, 100.0},
    {"within_2_sigma", "    within two", "%", 1, 100.0},
};

/// A column of the table of depth errors.
constexpr Row kDepthColumns[] = {{"rmse", "RMSE", "m", 3},
                                 {"mae", "MAE", "m", 3},
                                 {"abs_rel", "AbsRel", "", 4},
                                 {"delta_1.25", "<1.25", "%", 2, 100.0},
                                 {"coverage", "covered", "%", 1, 100.0}};

constexpr int kLabelWidth = 44;
constexpr int kDepthLabelWidth = 18;
constexpr int kNumberWidth = 12;

void PrintRows(std::span<const Row> rows, const nlohmann::json& report, std::ostream& out) {
  for (const Row& row : rows) {
    if (!report.contains(row.key) || report[row.key].is_null()) continue;
    out << std::left << std::setw(kLabelWidth) << row.label << std::right << std::setw(kNumberWidth)
        << std::setprecision(row.decimals) << row.factor * report[row.key].get<double>() << ' '
        << row.unit << '\n';
  }
}

nlohmann::json ToJson(const DepthErrorBin& bin) {
  return {{"rmse", bin.Rmse()},
          {"mae", bin.Mae()},
          {"abs_rel", bin.AbsRel()},
          {"delta_1.25", bin.Delta125()},
          {"coverage", bin.Coverage()}};
}

nlohmann::json ToJson(const DepthErrorBin& bin, double from, double to) {
  nlohmann::json json = ToJson(bin);
  json["from"] = from;
  json["to"] = to;
  return json;
}

nlohmann::json ToJson(const DepthCalibration& calibration) {
  nlohmann::json json;
  for (const DepthCalibration::Tenth& tenth : calibration.Tenths()) {
    json["tenths"].push_back({{"stated", tenth.stated}, {"observed", tenth.observed}});
  }
  for (const double coverage : {0.5, 0.8}) {
    json["risk"].push_back({{"coverage", coverage}, {"abs_rel", calibration.Risk(coverage)}});
  }
  return json;
}

void PrintDepthRow(const std::string& label, const nlohmann::json& bin, std::ostream& out) {
  out << std::left << std::setw(kDepthLabelWidth) << label << std::right;
  for (const Row& column : kDepthColumns) {
    out << std::setw(kNumberWidth) << std::setprecision(column.decimals)
        << column.factor * bin[column.key].get<double>();
  }
  out << '\n';
}

void PrintDepthBins(const nlohmann::json& bins, const char* unit, std::ostream& out) {
  for (const nlohmann::json& bin : bins) {
    if (std::isnan(bin["rmse"].get<double>())) continue;
    std::ostringstream label;
    label << "  " << bin["from"].get<double>() << " to " << bin["to"].get<double>() << ' ' << unit;
    PrintDepthRow(label.str(), bin, out);
  }
}

/// The images whose ranges have the largest relative errors.
void PrintWorstImages(nlohmann::json images, std::ostream& out) {
  constexpr size_t kCount = 3;
  const auto abs_rel = [](const nlohmann::json& image) { return image["abs_rel"].get<double>(); };
  // One that has nothing to compare has no errors.
  std::erase_if(images.get_ref<nlohmann::json::array_t&>(),
                [&](const nlohmann::json& image) { return std::isnan(abs_rel(image)); });
  std::ranges::stable_sort(images.get_ref<nlohmann::json::array_t&>(), std::greater(), abs_rel);
  if (!images.empty()) out << "the worst images\n";
  for (size_t i = 0; i < std::min(kCount, images.size()); ++i) {
    PrintDepthRow("  " + images[i]["name"].get<std::string>(), images[i], out);
  }
}

void PrintCalibration(const nlohmann::json& calibration, std::ostream& out) {
  constexpr int kWidth = 8;
  out << "relative error of each tenth of the ranges, from the most confident on, %\n"
      << std::setprecision(1);
  for (const char* key : {"stated", "observed"}) {
    out << std::left << std::setw(kDepthLabelWidth) << std::string("  ") + key << std::right;
    for (const nlohmann::json& tenth : calibration["tenths"]) {
      out << std::setw(kWidth) << 100 * tenth[key].get<double>();
    }
    out << '\n';
  }
}

void PrintDepth(const nlohmann::json& depth, std::ostream& out) {
  std::ostringstream title;
  title << "depth, " << depth["images"] << " images";
  out << '\n' << std::left << std::setw(kDepthLabelWidth) << title.str() << std::right;
  for (const Row& column : kDepthColumns) {
    out << std::setw(kNumberWidth) << std::string(column.label) + ' ' + column.unit;
  }
  out << '\n';
  PrintDepthRow("all", depth["all"], out);
  PrintDepthBins(depth["by_range_m"], "m", out);
  PrintDepthBins(depth["by_latitude_deg"], "deg", out);
  PrintWorstImages(depth["by_image"], out);
  if (depth.contains("calibration")) PrintCalibration(depth["calibration"], out);
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

nlohmann::json ToJson(const DepthFolderErrors& depth) {
  nlohmann::json json = {{"images", depth.images.size()}, {"all", ToJson(depth.errors.total)}};
  for (const DepthImageErrors& image : depth.images) {
    json["by_image"].push_back(ToJson(image.total));
    json["by_image"].back()["name"] = image.name;
  }
  double from = 0.0;
  for (size_t i = 0; i < DepthErrors::kRangeEnds.size(); ++i) {
    const double to = DepthErrors::kRangeEnds[i];
    json["by_range_m"].push_back(ToJson(depth.errors.by_range[i], from, to));
    from = to;
  }
  constexpr double kBandHeight = 180.0 / DepthErrors::kLatitudeBands;
  for (int i = 0; i < DepthErrors::kLatitudeBands; ++i) {
    json["by_latitude_deg"].push_back(ToJson(depth.errors.by_latitude[static_cast<size_t>(i)],
                                             kBandHeight * i - 90.0, kBandHeight * (i + 1) - 90.0));
  }
  if (depth.calibration) json["calibration"] = ToJson(*depth.calibration);
  return json;
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
