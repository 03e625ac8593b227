#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/slam/io/positions/byte_writer.h"

namespace orb360 {

/// The position that an Exif block states.
struct ExifFields {
  double latitude = 0, longitude = 0;
  double altitude = 0;
  int altitude_reference = 0;
  std::string date = {};  // YYYY:MM:DD; empty: no time either
  double time_of_day = 0;
  double horizontal_error = 0;  // metres; 0: not stated
  int version = 3;              // of the GPS directory: 2.VERSION
  std::string taken = {};       // DateTimeOriginal, YYYY:MM:DD HH:MM:SS; empty: none
};

/// The segment APP1 with a GPS directory, to be inserted behind the first two bytes of a JPEG.
inline std::string WriteExifSegment(const ExifFields& fields,
                                    std::endian order = std::endian::little) {
  struct Entry {
    std::uint16_t tag, type;
    std::uint32_t count;
    std::string value;
  };
  std::vector<Entry> entries;
  const auto ascii = [&](std::uint16_t tag, const std::string& text) {
    const std::string value = text + '\0';
    entries.push_back({tag, 2, static_cast<std::uint32_t>(value.size()), value});
  };
  const auto rationals = [&](std::uint16_t tag, const std::vector<double>& numbers,
                             std::uint32_t denominator) {
    std::string value;
    for (const double number : numbers) {
      Append(&value, static_cast<std::uint32_t>(std::llround(number * denominator)), order);
      Append(&value, denominator, order);
    }
    entries.push_back({tag, 5, static_cast<std::uint32_t>(numbers.size()), value});
  };
  const auto angle = [&](std::uint16_t tag, double degrees) {
    const double whole = std::floor(std::abs(degrees));
    const double minutes = std::floor((std::abs(degrees) - whole) * 60);
    rationals(tag, {whole, minutes, (std::abs(degrees) - whole - minutes / 60) * 3600}, 100000);
  };
  entries.push_back({0, 1, 4, {2, static_cast<char>(fields.version), 0, 0}});
  ascii(1, fields.latitude < 0 ? "S" : "N");
  angle(2, fields.latitude);
  ascii(3, fields.longitude < 0 ? "W" : "E");
  angle(4, fields.longitude);
  entries.push_back({5, 1, 1, std::string(1, static_cast<char>(fields.altitude_reference))});
  rationals(6, {std::abs(fields.altitude)}, 1000);
  if (!fields.date.empty()) {
    const double hours = std::floor(fields.time_of_day / 3600);
    const double minutes = std::floor(fields.time_of_day / 60 - 60 * hours);
    rationals(7, {hours, minutes, fields.time_of_day - 3600 * hours - 60 * minutes}, 1000);
    ascii(29, fields.date);
  }
  if (fields.horizontal_error > 0) rationals(31, {fields.horizontal_error}, 1000);

  // The first directory points to that of GPS and, with a time, to Exif's own, which lies before
  // it.
  constexpr std::uint32_t kTakenSize = 2 + 12 + 4 + 20;
  const bool has_time = !fields.taken.empty();
  const std::uint32_t second = 8 + 2 + (has_time ? 24 : 12) + 4;
  const std::uint32_t gps = second + (has_time ? kTakenSize : 0);
  std::string tiff = order == std::endian::little ? "II" : "MM";
  const auto append_entry = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t count,
                                std::uint32_t value) {
    Append(&tiff, tag, order);
    Append(&tiff, type, order);
    Append(&tiff, count, order);
    Append(&tiff, value, order);
  };
  Append(&tiff, std::uint16_t{42}, order);
  Append(&tiff, std::uint32_t{8}, order);
  Append(&tiff, static_cast<std::uint16_t>(has_time ? 2 : 1), order);
  if (has_time) append_entry(0x8769, 4, 1, second);
  append_entry(0x8825, 4, 1, gps);
  Append(&tiff, std::uint32_t{0}, order);
  if (has_time) {
    Append(&tiff, std::uint16_t{1}, order);
    append_entry(0x9003, 2, 20, second + 18);
    Append(&tiff, std::uint32_t{0}, order);
    tiff += fields.taken + '\0';
  }
  size_t data_at = gps + 2 + 12 * entries.size() + 4;
  std::string data;
  Append(&tiff, static_cast<std::uint16_t>(entries.size()), order);
  for (const Entry& entry : entries) {
    Append(&tiff, entry.tag, order);
    Append(&tiff, entry.type, order);
    Append(&tiff, entry.count, order);
    if (entry.value.size() <= 4) {
      tiff += entry.value + std::string(4 - entry.value.size(), '\0');
    } else {
      Append(&tiff, static_cast<std::uint32_t>(data_at + data.size()), order);
      data += entry.value;
    }
  }
  Append(&tiff, std::uint32_t{0}, order);
  tiff += data;
  std::string segment = "\xff\xe1";
  Append(&segment, static_cast<std::uint16_t>(2 + 6 + tiff.size()));
  return segment + std::string("Exif\0\0", 6) + tiff;
}

/// Inserts the segment into a JPEG file's bytes.
inline std::string WithExif(const std::string& jpeg, const ExifFields& fields,
                            std::endian order = std::endian::little) {
  return jpeg.substr(0, 2) + WriteExifSegment(fields, order) + jpeg.substr(2);
}

}  // namespace orb360
