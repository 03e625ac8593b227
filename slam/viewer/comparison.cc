#include "slam/viewer/comparison.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/alignment.h"

namespace orb360 {
namespace {

constexpr double kMaxDifference = 0.02;   // seconds between poses that belong together
constexpr size_t kMinPairs = 3;           // as of `orb360 evaluate`
constexpr size_t kMaxPathPoints = 20000;  // of the other path that the page draws

double Rounded(double value) {
  constexpr double kDecimals = 1e5;
  return std::round(value * kDecimals) / kDecimals;
}

bool IsOnePlace(std::span<const Eigen::Vector3d> positions) {
  return std::ranges::all_of(positions, [&](const auto& p) { return p == positions.front(); });
}

}  // namespace

std::optional<Comparison> ComparePaths(std::span<const StampedPose> run, bool has_metres,
                                       const ComparedPath& other) {
  const std::vector<PosePair> pairs = PairPoses(other.poses, run, kMaxDifference);
  std::vector<Eigen::Vector3d> in_other;
  std::vector<Eigen::Vector3d> in_run;
  for (const PosePair& pair : pairs) {
    in_other.push_back(pair.truth_from_camera.translation);
    in_run.push_back(pair.estimate_from_camera.translation);
  }
  if (pairs.size() < kMinPairs || IsOnePlace(in_other) || IsOnePlace(in_run)) return std::nullopt;
  Comparison comparison;
  comparison.other = other;
  comparison.is_rigid = has_metres && other.has_metres;
  comparison.has_metres = has_metres || other.has_metres;
  Similarity3 other_from_run;
  if (comparison.is_rigid) {
    const std::optional<Rigid3> rigid = AlignRigid(in_run, in_other);
    if (!rigid) return std::nullopt;
    other_from_run = ToSimilarity(*rigid);
  } else {
    const std::optional<Similarity3> aligned =
        other.has_metres ? AlignSimilarity(in_run, in_other) : AlignSimilarity(in_other, in_run);
    if (!aligned) return std::nullopt;
    other_from_run = other.has_metres ? *aligned : aligned->Inverse();
  }
  comparison.run_from_other = other_from_run.Inverse();
  std::vector<double> distances;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const double distance = other.has_metres
                                ? (other_from_run * in_run[i] - in_other[i]).norm()
                                : (comparison.run_from_other * in_other[i] - in_run[i]).norm();
    comparison.errors.push_back({pairs[i].timestamp, distance});
    distances.push_back(distance);
  }
  comparison.statistics = Summarize(distances);
  return comparison;
}

nlohmann::json ComparisonJson(const Comparison& comparison) {
  const Similarity3& run_from_other = comparison.run_from_other;
  nlohmann::json json = {
      {"name", comparison.other.name},          {"isTruth", comparison.other.is_truth},
      {"isRigid", comparison.is_rigid},         {"scale", run_from_other.scale},
      {"rotation", nlohmann::json::array()},    {"translation", nlohmann::json::array()},
      {"path", nlohmann::json::array()},        {"unit", comparison.has_metres ? "m" : "units"},
      {"time", nlohmann::json::array()},        {"error", nlohmann::json::array()},
      {"rmse", comparison.statistics.rmse},     {"mean", comparison.statistics.mean},
      {"median", comparison.statistics.median}, {"max", comparison.statistics.max}};
  for (const double value : run_from_other.rotation.coeffs()) json["rotation"].push_back(value);
  for (const double value : run_from_other.translation) json["translation"].push_back(value);
  const std::vector<StampedPose>& poses = comparison.other.poses;
  const size_t step = (poses.size() + kMaxPathPoints - 1) / kMaxPathPoints;
  for (size_t i = 0; i < poses.size(); i += step) {
    const Eigen::Vector3d place = run_from_other * poses[i].world_from_camera.translation;
    for (const double value : place) json["path"].push_back(Rounded(value));
  }
  for (const Comparison::Error& error : comparison.errors) {
    json["time"].push_back(Rounded(error.timestamp));
    json["error"].push_back(Rounded(error.distance));
  }
  return json;
}

}  // namespace orb360
