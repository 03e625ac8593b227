// libFuzzer's target for what reads positions: samples of GoPro's telemetry (GPMF) and of camera
// motion metadata (CAMM), the GPS directory of Exif, GPX, and Insta360's trailer. GPX is refused
// with a UserError, the others accept any bytes; what they give must lie on Earth. The first byte
// chooses.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <sstream>
#include <string>
#include <string_view>

#include "slam/io/positions/camm.h"
#include "slam/io/positions/exif_gps.h"
#include "slam/io/positions/gpmf.h"
#include "slam/io/positions/gpx_file.h"
#include "slam/io/positions/insta360_trailer.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

void RequireOnEarth(std::span<const GeodeticFix> fixes) {
  for (const GeodeticFix& fix : fixes) Require(IsPlausible(fix));
}

void CheckGpmf(std::string_view bytes) {
  const GpmfPositions positions = ParseGpmf(bytes);
  RequireOnEarth(positions.fixes);
  double last = 0;
  for (const GeodeticFix& fix : positions.fixes) {
    Require(fix.timestamp >= last && fix.timestamp < 1);
    last = fix.timestamp;
  }
}

void CheckCamm(std::string_view bytes) {
  const CammPositions positions = ParseCamm(bytes);
  RequireOnEarth(positions.with_accuracy);
  RequireOnEarth(positions.without_accuracy);
}

void CheckExif(std::string_view bytes) {
  if (const std::optional<ExifPosition> position = ParseExifGps(bytes)) {
    Require(IsPlausible(position->fix));
  }
}

void CheckGpx(std::string_view bytes) {
  try {
    const PositionTrack track = ParseGpx(bytes, "file");
    RequireOnEarth(track.fixes);
    for (std::size_t i = 1; i < track.fixes.size(); ++i) {
      Require(track.fixes[i - 1].timestamp < track.fixes[i].timestamp);
    }
  } catch (const UserError&) {
    // The refusal of what is not allowed.
  }
}

void CheckInsta360(std::string_view bytes) {
  std::istringstream file{std::string(bytes)};
  RequireOnEarth(ReadInsta360Positions(file).fixes);
}

}  // namespace
}  // namespace orb360

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 5) {
    case 0:
      orb360::CheckGpmf(bytes);
      break;
    case 1:
      orb360::CheckCamm(bytes);
      break;
    case 2:
      orb360::CheckExif(bytes);
      break;
    case 3:
      orb360::CheckGpx(bytes);
      break;
    default:
      orb360::CheckInsta360(bytes);
  }
  return 0;
}
