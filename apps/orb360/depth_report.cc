#include "apps/orb360/depth_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>
#include <string>

#include "apps/orb360/report_row.h"

namespace orb360 {
namespace {

constexpr ReportRow kColumns[] = {{"rmse", "RMSE", "m", 3},
                                  {"mae", "MAE", "m", 3},
                                  {"abs_rel", "AbsRel", "", 4},
                                  {"delta_1.25", "<1.25", "%", 2, 100.0},
                                  {"coverage", "covered", "%", 1, 100.0}};

constexpr int kLabelWidth = 18;
constexpr int kNumberWidth = 12;

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
  for (const DepthCalibration::Means& tenth : calibration.Tenths()) {
    json["tenths"].push_back({{"stated", tenth.stated}, {"observed", tenth.observed}});
  }
  for (const double coverage : {0.5, 0.8}) {
    json["risk"].push_back({{"coverage", coverage}, {"abs_rel", calibration.Risk(coverage)}});
  }
  return json;
}

const char* NameOf(RangeSource source) {
  switch (source) {
    case RangeSource::kNetwork:
      return "network";
    case RangeSource::kMeasured:
      return "measured";
    case RangeSource::kCompleted:
      return "completed";
    case RangeSource::kBoundary:
      return "boundary";
    case RangeSource::kMovingObject:
      return "moving_object";
  }
  return "";
}

void PrintDepthRow(const std::string& label, const nlohmann::json& bin, std::ostream& out) {
  out << std::left << std::setw(kLabelWidth) << label << std::right;
  for (const ReportRow& column : kColumns) {
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
    out << std::left << std::setw(kLabelWidth) << std::string("  ") + key << std::right;
    for (const nlohmann::json& tenth : calibration["tenths"]) {
      out << std::setw(kWidth) << 100 * tenth[key].get<double>();
    }
    out << '\n';
  }
  if (!calibration.contains("sources")) return;
  out << "by how the range is known" << std::setw(11) << "of all" << std::setw(kNumberWidth)
      << "stated" << std::setw(kNumberWidth) << "observed, %" << '\n';
  for (const nlohmann::json& part : calibration["sources"]) {
    out << std::left << std::setw(kLabelWidth + 6) << "  " + part["source"].get<std::string>()
        << std::right;
    for (const char* key : {"fraction", "stated", "observed"}) {
      out << std::setw(kNumberWidth) << 100 * part[key].get<double>();
    }
    out << '\n';
  }
}

}  // namespace

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
  if (!depth.calibration) return json;
  json["calibration"] = ToJson(*depth.calibration);
  double solid_angle = 0;
  for (const auto& [source, part] : depth.by_source) solid_angle += part.solid_angle();
  for (const auto& [source, part] : depth.by_source) {
    json["calibration"]["sources"].push_back({{"source", NameOf(source)},
                                              {"fraction", part.solid_angle() / solid_angle},
                                              {"stated", part.Mean().stated},
                                              {"observed", part.Mean().observed}});
  }
  return json;
}

void PrintDepth(const nlohmann::json& depth, std::ostream& out) {
  std::ostringstream title;
  title << "depth, " << depth["images"] << " images";
  out << '\n' << std::left << std::setw(kLabelWidth) << title.str() << std::right;
  for (const ReportRow& column : kColumns) {
    out << std::setw(kNumberWidth) << std::string(column.label) + ' ' + column.unit;
  }
  out << '\n';
  PrintDepthRow("all", depth["all"], out);
  PrintDepthBins(depth["by_range_m"], "m", out);
  PrintDepthBins(depth["by_latitude_deg"], "deg", out);
  PrintWorstImages(depth["by_image"], out);
  if (depth.contains("calibration")) PrintCalibration(depth["calibration"], out);
}

}  // namespace orb360
