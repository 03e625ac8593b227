#include "slam/io/positions/exif_gps.h"

#include <cmath>
#include <cstdint>

#include "nn/base/number_text.h"
#include "slam/io/positions/utc_time.h"
#include "slam/io/tiff.h"

namespace orb360 {
namespace {

// Tags of the GPS directory; the pointer to it is a tag of the first directory.
enum Tag : std::uint16_t {
  kVersion = 0,
  kLatitudeRef = 1,
  kLatitude = 2,
  kLongitudeRef = 3,
  kLongitude = 4,
  kAltitudeRef = 5,
  kAltitude = 6,
  kTimeStamp = 7,
  kDop = 11,
  kDateStamp = 29,
  kHorizontalError = 31,
  kGpsDirectory = 0x8825,
};

/// Degrees of an entry with degrees, minutes and seconds, negative where its reference says so.
std::optional<double> Degrees(const Tiff& tiff, size_t directory, Tag tag, Tag reference,
                              std::string_view positive, std::string_view negative) {
  const std::string_view sign = FindText(tiff, directory, reference);
  if (sign != positive && sign != negative) return std::nullopt;
  const std::optional<double> degrees = FindFraction(tiff, directory, tag, 3, 0);
  const std::optional<double> minutes = FindFraction(tiff, directory, tag, 3, 1);
  if (!degrees || !minutes) return std::nullopt;
  // Minutes with decimals may leave the seconds 0/0.
  const double seconds = FindFraction(tiff, directory, tag, 3, 2).value_or(0);
  const double angle = *degrees + *minutes / 60 + seconds / 3600;
  return sign == negative ? -angle : angle;
}

void ReadAltitude(const Tiff& tiff, size_t directory, ExifPosition* position) {
  const std::optional<double> altitude = FindFraction(tiff, directory, kAltitude, 1, 0);
  if (!altitude) return;
  const std::optional<TiffEntry> entry = FindEntry(tiff, directory, kAltitudeRef);
  const int reference =
      entry && entry->type == TiffType::kByte ? tiff.At<std::uint8_t>(entry->value).value_or(0) : 0;
  // 0 above and 1 below sea level; in Exif 3.0, whose GPS directory has the version 2.4, these are
  // above and below the ellipsoid, and 2 and 3 above and below sea level.
  position->fix.altitude = reference % 2 == 1 ? -*altitude : *altitude;
  const std::optional<TiffEntry> version = FindEntry(tiff, directory, kVersion);
  const bool is_exif3 = version && version->type == TiffType::kByte && version->count == 4 &&
                        tiff.At<std::uint8_t>(version->value) == 2 &&
                        tiff.At<std::uint8_t>(version->value + 1).value_or(0) >= 4;
  position->altitude_reference =
      is_exif3 && reference < 2 ? AltitudeReference::kEllipsoid : AltitudeReference::kMeanSeaLevel;
}

std::optional<double> ReadUtc(const Tiff& tiff, size_t directory) {
  const std::string_view date = FindText(tiff, directory, kDateStamp);  // YYYY:MM:DD
  const auto hours = FindFraction(tiff, directory, kTimeStamp, 3, 0);
  const auto minutes = FindFraction(tiff, directory, kTimeStamp, 3, 1);
  const auto seconds = FindFraction(tiff, directory, kTimeStamp, 3, 2);
  if (date.size() != 10 || !hours || !minutes || !seconds) return std::nullopt;
  const auto part = [&](size_t at, size_t length) {
    return ParseNumber<int>(date.substr(at, length)).value_or(-1);
  };
  const std::optional<double> midnight = UtcSeconds(part(0, 4), part(5, 2), part(8, 2), 0, 0, 0);
  const double of_day = 3600 * *hours + 60 * *minutes + *seconds;
  if (!midnight || !(of_day < 86401)) return std::nullopt;
  return *midnight + of_day;
}

}  // namespace

std::optional<ExifPosition> ParseExifGps(std::string_view exif) {
  const std::optional<Tiff> tiff = OpenTiff(exif);
  const std::optional<size_t> first = tiff ? FirstDirectory(*tiff) : std::nullopt;
  const std::optional<size_t> directory =
      first ? FindDirectory(*tiff, *first, kGpsDirectory) : std::nullopt;
  if (!directory) return std::nullopt;
  const size_t gps = *directory;
  const auto latitude = Degrees(*tiff, gps, kLatitude, kLatitudeRef, "N", "S");
  const auto longitude = Degrees(*tiff, gps, kLongitude, kLongitudeRef, "E", "W");
  if (!latitude || !longitude) return std::nullopt;
  ExifPosition position;
  position.fix.latitude = *latitude;
  position.fix.longitude = *longitude;
  ReadAltitude(*tiff, gps, &position);
  const std::optional<double> error = FindFraction(*tiff, gps, kHorizontalError, 1, 0);
  const std::optional<double> dop = FindFraction(*tiff, gps, kDop, 1, 0);
  if (error && *error > 0) {
    position.fix.horizontal_sigma = *error;
  } else if (dop && *dop > 0) {
    position.fix.horizontal_sigma = *dop * kMetresPerDop;
  }
  position.utc = ReadUtc(*tiff, gps);
  if (!IsPlausible(position.fix)) return std::nullopt;
  return position;
}

}  // namespace orb360
