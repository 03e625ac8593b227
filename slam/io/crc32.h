#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace orb360 {

/// Returns the CRC-32 of data (ISO 3309, the one of zlib and PNG: reflected polynomial 0xEDB88320),
/// continued from that of what lies before them.
inline std::uint32_t Crc32(std::string_view data, std::uint32_t before = 0) {
  static constexpr std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
      std::uint32_t crc = byte;
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320U : 0U);
      table[byte] = crc;
    }
    return table;
  }();
  std::uint32_t crc = ~before;
  for (const char byte : data) {
    crc = crc >> 8 ^ kTable[(crc ^ static_cast<unsigned char>(byte)) & 0xFFU];
  }
  return ~crc;
}

}  // namespace orb360
