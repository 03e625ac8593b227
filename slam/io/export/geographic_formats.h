#pragma once

#include <filesystem>
#include <span>

#include "slam/io/positions/georeference.h"
#include "slam/io/sparse_model.h"

namespace orb360 {

// Writers of a path in geographic coordinates (WGS 84, degrees). Each places the frames, of which
// there is one or more, by `georeference`, writes them in their order, and states what heights are
// measured from (Georeference::altitude_reference). UTC is written where the georeference tells it.
// They throw UserError where the disk fails, for a single frame (ExportGeojson and ExportKml, whose
// lines have two points or more), and where this build has no PROJ. docs/formats/export.md
// describes the formats.

/// Writes `trajectory.geojson`, a collection with one LineString (RFC 7946). Its properties have
/// the frames' `timestamps` (seconds, on the clock of the input) and `times` (ISO 8601, UTC).
void ExportGeojson(std::span<const PosedFrame> frames, const Georeference& georeference,
                   const std::filesystem::path& folder);

/// Writes `trajectory.gpx`, one track of one segment (GPX 1.1).
void ExportGpx(std::span<const PosedFrame> frames, const Georeference& georeference,
               const std::filesystem::path& folder);

/// Writes `trajectory.kml` (OGC KML 2.2): a gx:Track where UTC is known, else a LineString.
void ExportKml(std::span<const PosedFrame> frames, const Georeference& georeference,
               const std::filesystem::path& folder);

}  // namespace orb360
