#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "slam/io/positions/position_track.h"
#include "slam/io/positions/projection.h"
#include "slam/scale/position_alignment.h"
#include "slam/scale/scale_measurement.h"

namespace orb360 {

/// Where the world of a run's files lies on Earth, and how well that is known.
struct Georeference {
  /// Origin of the local frame: x to the east, y to the north, z up, metres (Projection::Local).
  /// Its height is over `altitude_reference`; where this is not the ellipsoid, heights of the
  /// result are over it as well, because the geoid is level enough within a recording.
  GeodeticPoint origin;
  AltitudeReference altitude_reference = AltitudeReference::kUnknown;
  /// `local_from_path` is local_from_world.
  PositionAlignment alignment;
  /// UTC at the timestamp 0 of the frames, seconds since 1970, where the positions tell it.
  std::optional<double> utc_at_zero;
  std::string source;  ///< Of the positions.
};

/// Name of the file in the folder of a run.
inline constexpr const char* kGeoreferenceName = "georeference.json";

/// What is known of a path before its positions.
struct PathKnowledge {
  UpDirection up;  ///< In the frame of the path.
  std::optional<ScaleMeasurement> scale;
  /// UTC of the timestamp 0 of the frames with a standard deviation of a second, where the user
  /// gave it.
  std::optional<double> utc_at_zero;
};

/// The positions of a track in the local frame of a place in its middle, for System::Finish and
/// AlignPositions. Fixes without a stated accuracy get 4 m. Throws UserError where this build has
/// no PROJ.
struct LocalPositions {
  GeodeticPoint origin;
  Positions positions;
};
LocalPositions MakeLocal(const PositionTrack& track, const std::optional<double>& utc_at_zero);

/// Places a path, whose times ascend, on Earth by a track. The origin becomes the place of the fix
/// in the middle of the path. Throws UserError, which names the source, where that is not possible.
Georeference PlaceOnEarth(std::span<const PathPoint> path, const PositionTrack& track,
                          const PathKnowledge& known);

/// Writes `georeference.json` (docs/formats/georeference.md). Throws UserError.
void WriteGeoreference(const std::filesystem::path& path, const Georeference& georeference);

/// Reads the file back. Throws UserError where it is missing, damaged or of another version.
Georeference ReadGeoreference(const std::filesystem::path& path);

}  // namespace orb360
