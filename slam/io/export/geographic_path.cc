#include "slam/io/export/geographic_path.h"

#include "nn/base/number_text.h"
#include "slam/io/positions/utc_time.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

GeographicPath PlaceFrames(std::span<const PosedFrame> frames, const Georeference& georeference) {
  const Projection local = Projection::Local(georeference.origin);
  const Similarity3& local_from_world = georeference.alignment.local_from_path;
  GeographicPath path;
  for (const PosedFrame& frame : frames) {
    path.places.push_back(
        local.ToGeodetic(local_from_world * frame.world_from_optical.translation));
    if (georeference.utc_at_zero) {
      path.times.push_back(FormatIsoTime(*georeference.utc_at_zero + frame.timestamp));
    }
  }
  return path;
}

void RequireLine(std::span<const PosedFrame> frames, const std::string& format) {
  if (frames.size() >= 2) return;
  throw UserError(format + ": one frame makes no line; export more with --frames all");
}

std::string DegreesText(double degrees) { return ToFixedText(degrees, 9); }

std::string HeightText(double metres) { return ToFixedText(metres, 4); }

std::string DescribeOrigin(const Georeference& georeference) {
  return "placed by " + georeference.source +
         "; heights over: " + ToString(georeference.altitude_reference);
}

}  // namespace orb360
