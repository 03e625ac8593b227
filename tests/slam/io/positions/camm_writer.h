#pragma once

#include <cstdint>
#include <string>

#include "tests/slam/io/positions/byte_writer.h"

namespace orb360 {

inline std::string CammHeader(int type) {
  std::string packet(2, '\0');
  Append(&packet, static_cast<std::uint16_t>(type), std::endian::little);
  return packet;
}

inline std::string CammType5(double latitude, double longitude, double altitude) {
  std::string packet = CammHeader(5);
  for (const double value : {latitude, longitude, altitude}) {
    Append(&packet, value, std::endian::little);
  }
  return packet;
}

/// A packet of gyroscope measurements, which has no position.
inline std::string CammType2() { return CammHeader(2) + std::string(12, '\0'); }

inline std::string CammType6(double time, int fix, double latitude, double longitude,
                             float altitude, float horizontal_accuracy, float vertical_accuracy) {
  std::string packet = CammHeader(6);
  Append(&packet, time, std::endian::little);
  Append(&packet, static_cast<std::int32_t>(fix), std::endian::little);
  Append(&packet, latitude, std::endian::little);
  Append(&packet, longitude, std::endian::little);
  for (const float value : {altitude, horizontal_accuracy, vertical_accuracy, 0.F, 0.F, 0.F, 1.F}) {
    Append(&packet, value, std::endian::little);
  }
  return packet;
}

}  // namespace orb360
