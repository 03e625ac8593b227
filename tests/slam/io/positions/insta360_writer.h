#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/slam/io/positions/byte_writer.h"

namespace orb360 {

/// One measurement of a GPS record.
inline std::string Insta360Measurement(double utc, double latitude, double longitude,
                                       double altitude, char status = 'A', char west = 'W') {
  constexpr std::endian kOrder = std::endian::little;
  std::string bytes;
  const auto seconds = static_cast<std::uint64_t>(utc);
  Append(&bytes, seconds, kOrder);
  Append(&bytes, static_cast<std::uint16_t>(1000 * (utc - static_cast<double>(seconds)) + 0.5),
         kOrder);
  bytes += status;
  Append(&bytes, latitude < 0 ? -latitude : latitude, kOrder);
  bytes += latitude < 0 ? 'S' : 'N';
  Append(&bytes, longitude < 0 ? -longitude : longitude, kOrder);
  bytes += longitude < 0 ? west : 'E';
  for (const double value : {2.5, 90.0, altitude}) Append(&bytes, value, kOrder);
  return bytes;
}

struct Insta360Record {
  char kind = 0;
  std::string content;
};

/// The format and kind of a record, and its size.
inline std::string Insta360Header(const Insta360Record& record) {
  std::string bytes = {'\0', record.kind};
  Append(&bytes, static_cast<std::uint32_t>(record.content.size()), std::endian::little);
  return bytes;
}

inline std::string Insta360Footer(size_t records_size) {
  std::string bytes(32, '\0');
  Append(&bytes, static_cast<std::uint32_t>(records_size + 72), std::endian::little);
  Append(&bytes, std::uint32_t{3}, std::endian::little);
  return bytes + "8db42d694ccc418790edff439fe026bf";
}

/// The trailer of older cameras: each record is followed by its header.
inline std::string Insta360Trailer(const std::vector<Insta360Record>& records) {
  std::string bytes;
  for (const Insta360Record& record : records) bytes += record.content + Insta360Header(record);
  return bytes + Insta360Footer(bytes.size());
}

/// The trailer of newer ones: an index, and gaps between the records.
inline std::string IndexedInsta360Trailer(const std::vector<Insta360Record>& records) {
  std::string bytes, index;
  for (const Insta360Record& record : records) {
    bytes += std::string(100, '\0');
    index += std::string{record.kind, '\0'};
    Append(&index, static_cast<std::uint32_t>(record.content.size()), std::endian::little);
    Append(&index, static_cast<std::uint32_t>(bytes.size()), std::endian::little);
    bytes += record.content;
  }
  bytes += index + Insta360Header({0, index});
  return bytes + Insta360Footer(bytes.size());
}

}  // namespace orb360
