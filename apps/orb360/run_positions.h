#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "slam/io/export/export_scene.h"
#include "slam/io/positions/georeference.h"
#include "slam/io/sparse_model.h"

namespace orb360 {

/// The command line of positions.
struct PositionOptions {
  std::string file;       // "": what the input carries; or "none"
  std::string utc_start;  // UTC of the input's first frame, ISO 8601; "": unknown
};

/// Adds --utc-start to a command.
void AddUtcStartOption(CLI::App* command, PositionOptions* options);

/// Returns --utc-start in seconds since 1970; none for "". Throws UserError for what is no time.
std::optional<double> ParseUtcStart(const PositionOptions& options);

/// Positions for a run that is about to begin.
struct RunPositions {
  PositionTrack track;
  Positions local;             ///< The same, for System::Finish.
  bool is_from_input = false;  ///< Whether nobody gave them: the input itself carries them.
};

/// Reads the positions of a run. `frame_rate`: --fps, frames per second, where it was given. Throws
/// UserError where --positions names a file that cannot be used, and for a wrong --utc-start. Where
/// the input itself carries positions that cannot be used, there are none, and `warning` says why.
std::optional<RunPositions> ReadRunPositions(const PositionOptions& options,
                                             const std::string& input,
                                             const std::optional<double>& frame_rate,
                                             std::string* warning);

/// The vertical of a model's largest map: the normal of the ground where the run is levelled, which
/// holds for its first map, else the upper side of the first camera.
inline UpDirection UpOfLargestMap(const SparseModel& model, bool is_levelled) {
  const bool is_ground = is_levelled && LargestMap(model) == 0;
  return {Eigen::Vector3d::UnitZ(), is_ground ? kGroundUpSigma : kCameraUpSigma};
}

/// Places the largest map of a run (LargestMap) on Earth by all its frames. Throws UserError where
/// that is not possible. Contract: the model has a frame.
Georeference PlaceLargestMap(const SparseModel& model, const PositionTrack& track,
                             const PathKnowledge& known);

/// What has become of the positions of a run.
struct GeoreferenceResult {
  std::optional<Georeference> georeference;
  std::string failure;         ///< Why there is none; "" where there is, or no positions.
  nlohmann::json description;  ///< DescribePositions; null without positions.
};

/// Places a run whose scale has been estimated with the positions. `is_levelled`: as in
/// UpOfLargestMap.
GeoreferenceResult PlaceRun(const SparseModel& model, const std::optional<RunPositions>& positions,
                            bool is_levelled, const std::optional<double>& utc_start);

/// Writes georeference.json into the folder of a run, or removes that of an earlier run there.
void SaveGeoreference(const std::filesystem::path& run_folder,
                      const std::optional<Georeference>& georeference);

/// What has become of positions: `positions` of summary.json (docs/formats/summary.md).
/// `georeference` is null where they could not be used, and `failure` says why.
nlohmann::json DescribePositions(const PositionTrack& track, const Georeference* georeference,
                                 const std::string& failure);

/// Whether what DescribePositions has returned, or null, tells of a run that was placed.
inline bool IsPlaced(const nlohmann::json& positions) {
  return !positions.is_null() && positions["failure"].is_null();
}

/// Says in one line where a run was placed and how well, or why not. `positions` is what
/// DescribePositions has returned.
std::string StatePositions(const nlohmann::json& positions);

}  // namespace orb360
