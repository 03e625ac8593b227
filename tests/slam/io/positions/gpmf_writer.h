#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/slam/io/positions/byte_writer.h"

namespace orb360 {

/// A measurement as a GoPro's receiver makes it.
struct GpmfMeasurement {
  double latitude, longitude, altitude;  // degrees, metres
  double dop = 1.5;
  int fix = 3;
  double utc_days = 0, utc_seconds = 0;  // since 2000 and since midnight
};

inline std::string Klv(const std::string& key, char type, int size, int count,
                       const std::string& value) {
  std::string klv = key;
  klv += type;
  Append(&klv, static_cast<std::uint8_t>(size));
  Append(&klv, static_cast<std::uint16_t>(count));
  klv += value;
  klv.append((4 - value.size() % 4) % 4, '\0');
  return klv;
}

inline std::string Nested(const std::string& key, const std::string& value) {
  return Klv(key, '\0', 4, static_cast<int>(value.size() / 4), value);
}

template <typename Number>
std::string Numbers(const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) Append(&bytes, static_cast<Number>(std::llround(value)));
  return bytes;
}

inline std::string Device(const std::string& stream) {
  return Nested("DEVC", Klv("DVID", 'L', 4, 1, Numbers<std::uint32_t>({1})) +
                            Klv("DVNM", 'c', 1, 10, "GoPro Test") + Nested("STRM", stream));
}

/// A sample of a telemetry track with one stream GPS5. `utc`: yymmddhhmmss.sss.
inline std::string WriteGps5(const std::vector<GpmfMeasurement>& measurements,
                             const std::string& utc) {
  std::string values;
  for (const GpmfMeasurement& m : measurements) {
    values += Numbers<std::int32_t>(
        {1e7 * m.latitude, 1e7 * m.longitude, 1e3 * m.altitude, 1e3 * 4.0, 1e2 * 4.1});
  }
  const GpmfMeasurement& first = measurements.front();
  return Device(Klv("GPSF", 'L', 4, 1, Numbers<std::uint32_t>({double(first.fix)})) +
                Klv("GPSU", 'U', 16, 1, utc) +
                Klv("GPSP", 'S', 2, 1, Numbers<std::uint16_t>({100 * first.dop})) +
                Klv("UNIT", 'c', 3, 5, "degdegm  m/sm/s") +
                Klv("SCAL", 'l', 4, 5, Numbers<std::int32_t>({1e7, 1e7, 1e3, 1e3, 1e2})) +
                Klv("GPSA", 'F', 4, 1, "MSLV") +
                Klv("GPS5", 'l', 20, static_cast<int>(measurements.size()), values));
}

/// The same with one stream GPS9.
inline std::string WriteGps9(const std::vector<GpmfMeasurement>& measurements) {
  std::string values;
  for (const GpmfMeasurement& m : measurements) {
    values += Numbers<std::int32_t>({1e7 * m.latitude, 1e7 * m.longitude, 1e3 * m.altitude,
                                     1e3 * 4.0, 1e2 * 4.1, m.utc_days, 1e3 * m.utc_seconds});
    values += Numbers<std::uint16_t>({100 * m.dop, double(m.fix)});
  }
  return Device(
      Klv("TYPE", 'c', 1, 9, "lllllllSS") +
      Klv("SCAL", 'l', 4, 9, Numbers<std::int32_t>({1e7, 1e7, 1e3, 1e3, 1e2, 1, 1e3, 100, 1})) +
      Klv("GPS9", '?', 32, static_cast<int>(measurements.size()), values));
}

}  // namespace orb360
