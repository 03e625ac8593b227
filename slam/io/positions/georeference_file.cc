#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include <nlohmann/json.hpp>

#include "slam/io/atomic_file.h"
#include "slam/io/json_text.h"
#include "slam/io/positions/georeference.h"
#include "slam/io/positions/utc_time.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kVersion = 1;
constexpr double kDegree = std::numbers::pi / 180;

nlohmann::json OrNull(double number) {
  return std::isfinite(number) ? nlohmann::json(number) : nlohmann::json();
}

double OrInfinity(const nlohmann::json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

nlohmann::json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d ToVector(const nlohmann::json& json) {
  const auto numbers = json.get<std::array<double, 3>>();
  return {numbers[0], numbers[1], numbers[2]};
}

nlohmann::json ToJson(const Georeference& georeference) {
  const PositionAlignment& alignment = georeference.alignment;
  const Similarity3& local_from_world = alignment.local_from_path;
  const Eigen::Quaterniond& q = local_from_world.rotation;
  const GeodeticPoint& origin = georeference.origin;
  nlohmann::json json = {
      {"version", kVersion},
      {"origin",
       {{"latitude", origin.latitude},
        {"longitude", origin.longitude},
        {"altitude", origin.height}}},
      {"altitude_reference", ToString(georeference.altitude_reference)},
      {"utm_epsg", nullptr},
      {"local_from_world",
       {{"scale", local_from_world.scale},
        {"rotation", {q.x(), q.y(), q.z(), q.w()}},
        {"translation", ToJson(local_from_world.translation)}}},
      {"sigma",
       {{"scale", alignment.log_scale_sigma},
        {"heading_deg", alignment.heading_sigma / kDegree},
        {"tilt_deg", alignment.tilt_sigma / kDegree},
        {"horizontal", alignment.horizontal_sigma},
        {"vertical", OrNull(alignment.vertical_sigma)}}},
      {"center", ToJson(alignment.center)},
      {"clock_offset",
       {{"value", alignment.clock_offset}, {"sigma", alignment.clock_offset_sigma}}},
      {"utc_at_zero", nullptr},
      {"fixes",
       {{"source", georeference.source},
        {"used", alignment.num_fixes},
        {"sigma", alignment.noise.sigma},
        {"correlated_fraction", alignment.noise.correlated_fraction},
        {"correlation_time", alignment.noise.correlation_time},
        {"median_distance", alignment.median_distance}}}};
  if (const std::optional<int> epsg = UtmEpsg(origin)) json["utm_epsg"] = *epsg;
  if (georeference.utc_at_zero) json["utc_at_zero"] = FormatIsoTime(*georeference.utc_at_zero);
  return json;
}

Georeference FromJson(const nlohmann::json& json) {
  Georeference georeference;
  const nlohmann::json& origin = json.at("origin");
  georeference.origin = {origin.at("latitude").get<double>(), origin.at("longitude").get<double>(),
                         origin.at("altitude").get<double>()};
  const auto reference = json.at("altitude_reference").get<std::string>();
  for (const AltitudeReference value :
       {AltitudeReference::kEllipsoid, AltitudeReference::kMeanSeaLevel}) {
    if (reference == ToString(value)) georeference.altitude_reference = value;
  }
  PositionAlignment& alignment = georeference.alignment;
  const nlohmann::json& transform = json.at("local_from_world");
  const auto q = transform.at("rotation").get<std::array<double, 4>>();
  alignment.local_from_path = {transform.at("scale").get<double>(),
                               Eigen::Quaterniond(q[3], q[0], q[1], q[2]),
                               ToVector(transform.at("translation"))};
  const nlohmann::json& sigma = json.at("sigma");
  alignment.log_scale_sigma = sigma.at("scale").get<double>();
  alignment.heading_sigma = sigma.at("heading_deg").get<double>() * kDegree;
  alignment.tilt_sigma = sigma.at("tilt_deg").get<double>() * kDegree;
  alignment.horizontal_sigma = sigma.at("horizontal").get<double>();
  alignment.vertical_sigma = OrInfinity(sigma.at("vertical"));
  alignment.center = ToVector(json.at("center"));
  alignment.clock_offset = json.at("clock_offset").at("value").get<double>();
  alignment.clock_offset_sigma = json.at("clock_offset").at("sigma").get<double>();
  if (!json.at("utc_at_zero").is_null()) {
    georeference.utc_at_zero = ParseIsoTime(json.at("utc_at_zero").get<std::string>());
  }
  const nlohmann::json& fixes = json.at("fixes");
  georeference.source = fixes.at("source").get<std::string>();
  alignment.num_fixes = fixes.at("used").get<int>();
  alignment.noise = {fixes.at("sigma").get<double>(), fixes.at("correlated_fraction").get<double>(),
                     fixes.at("correlation_time").get<double>()};
  alignment.median_distance = fixes.at("median_distance").get<double>();
  return georeference;
}

bool IsSound(const Georeference& georeference) {
  const GeodeticPoint& origin = georeference.origin;
  const Similarity3& transform = georeference.alignment.local_from_path;
  return std::abs(origin.latitude) <= 90 && std::abs(origin.longitude) <= 180 &&
         std::isfinite(origin.height) && std::isfinite(transform.scale) && transform.scale > 0 &&
         std::abs(transform.rotation.norm() - 1) < 1e-6 && transform.translation.allFinite();
}

}  // namespace

void WriteGeoreference(const std::filesystem::path& path, const Georeference& georeference) {
  WriteFileAtomically(path, ToJsonText(ToJson(georeference), 2) + "\n");
}

Georeference ReadGeoreference(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw UserError(
        path.string() +
        ": cannot be opened; `orb360 georeference` or `orb360 run --positions` makes it");
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    if (json.at("version").get<int>() != kVersion) {
      throw UserError(
          path.string() +
          ": was written by another version of orb360; run `orb360 georeference` again");
    }
    Georeference georeference = FromJson(json);
    if (IsSound(georeference)) return georeference;
  } catch (const nlohmann::json::exception&) {
  }
  throw UserError(path.string() + ": is damaged; run `orb360 georeference` again");
}

}  // namespace orb360
