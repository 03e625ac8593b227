#include "apps/orb360/run_positions.h"

#include <vector>

#include "apps/orb360/input.h"
#include "nn/base/number_text.h"
#include "slam/io/positions/read_positions.h"
#include "slam/io/positions/utc_time.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

void AddUtcStartOption(CLI::App* command, PositionOptions* options) {
  command
      ->add_option("--utc-start", options->utc_start,
                   "When the input begins, to a second, such as 2025-03-14T07:00:00Z; needed only "
                   "where a track fits the path at several times")
      ->type_name("TIME");
}

std::optional<double> ParseUtcStart(const PositionOptions& options) {
  if (options.utc_start.empty()) return std::nullopt;
  if (const std::optional<double> utc = ParseIsoTime(options.utc_start)) return utc;
  throw UserError("--utc-start: `" + options.utc_start +
                  "` is no time such as 2025-03-14T07:00:00Z or 2025-03-14T09:00:00+02:00");
}

std::optional<RunPositions> ReadRunPositions(const PositionOptions& options,
                                             const std::string& input,
                                             const std::optional<double>& frame_rate,
                                             std::string* warning) {
  const std::optional<double> utc_start = ParseUtcStart(options);
  if (options.file == "none") return std::nullopt;
  const auto with_local = [&](PositionTrack track, bool is_from_input) {
    Positions local = MakeLocal(track, utc_start).positions;
    return RunPositions{std::move(track), std::move(local), is_from_input};
  };
  if (!options.file.empty()) return with_local(ReadPositions(options.file, frame_rate), false);
  if (IsRendered(input)) return std::nullopt;
  try {
    if (std::optional<PositionTrack> track = FindPositions(input, frame_rate)) {
      return with_local(std::move(*track), true);
    }
  } catch (const UserError& error) {
    *warning = std::string("the positions of the input are not used: ") + error.what();
  }
  return std::nullopt;
}

Georeference PlaceLargestMap(const SparseModel& model, const PositionTrack& track,
                             const PathKnowledge& known) {
  const int map = LargestMap(model);
  std::vector<PathPoint> path;
  for (const PosedFrame& frame : model.frames) {
    if (frame.map == map) path.push_back({frame.timestamp, frame.world_from_optical.translation});
  }
  return PlaceOnEarth(path, track, known);
}

GeoreferenceResult PlaceRun(const SparseModel& model, const std::optional<RunPositions>& positions,
                            bool is_levelled, const std::optional<double>& utc_start) {
  GeoreferenceResult placed;
  if (!positions) return placed;
  try {
    if (model.frames.empty()) throw UserError("no frame of the run has a pose");
    placed.georeference = PlaceLargestMap(
        model, positions->track, {UpOfLargestMap(model, is_levelled), std::nullopt, utc_start});
  } catch (const UserError& error) {
    placed.failure = error.what();
  }
  placed.description = DescribePositions(
      positions->track, placed.georeference ? &*placed.georeference : nullptr, placed.failure);
  return placed;
}

void SaveGeoreference(const std::filesystem::path& run_folder,
                      const std::optional<Georeference>& georeference) {
  const std::filesystem::path path = run_folder / kGeoreferenceName;
  if (georeference) {
    WriteGeoreference(path, *georeference);
  } else {
    std::filesystem::remove(path);
  }
}

nlohmann::json DescribePositions(const PositionTrack& track, const Georeference* georeference,
                                 const std::string& failure) {
  nlohmann::json described = {{"source", track.source}, {"fixes", track.fixes.size()}};
  for (const char* key : {"used", "scale", "scale_sigma", "horizontal_sigma", "median_distance",
                          "clock_offset", "clock_offset_sigma", "utc_at_zero", "failure"}) {
    described[key] = nullptr;
  }
  if (georeference == nullptr) {
    described["failure"] = failure;
    return described;
  }
  const PositionAlignment& alignment = georeference->alignment;
  described["used"] = alignment.num_fixes;
  described["scale"] = alignment.local_from_path.scale;
  described["scale_sigma"] = alignment.log_scale_sigma;
  described["horizontal_sigma"] = alignment.horizontal_sigma;
  described["median_distance"] = alignment.median_distance;
  described["clock_offset"] = alignment.clock_offset;
  described["clock_offset_sigma"] = alignment.clock_offset_sigma;
  if (georeference->utc_at_zero) {
    described["utc_at_zero"] = FormatIsoTime(*georeference->utc_at_zero);
  }
  return described;
}

std::string StatePositions(const nlohmann::json& positions) {
  if (!IsPlaced(positions)) {
    return "not placed on Earth: " + positions["failure"].get<std::string>();
  }
  const auto number = [&](const char* key, double factor, int decimals) {
    return ToFixedText(factor * positions[key].get<double>(), decimals);
  };
  std::string text = "placed on Earth by " + positions["source"].get<std::string>() + ": " +
                     std::to_string(positions["used"].get<int>()) + " of " +
                     std::to_string(positions["fixes"].get<int>()) + " positions, " +
                     number("median_distance", 1, 2) + " m from the path in the median; scale " +
                     number("scale", 1, 4) + " (standard deviation " +
                     number("scale_sigma", 100, 2) + " %), place (" +
                     number("horizontal_sigma", 1, 2) + " m)";
  if (!positions["utc_at_zero"].is_null()) {
    text += ", start " + positions["utc_at_zero"].get<std::string>();
  } else {
    text += ", clock offset " + number("clock_offset", 1, 2) + " s";
  }
  return text + " (" + number("clock_offset_sigma", 1, 2) + " s)";
}

}  // namespace orb360
