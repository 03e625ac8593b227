#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace orb360 {

/// Reads the number of `sizeof(Number)` bytes that begins at byte `at`, stored in the given order.
/// Returns nullopt where the data end before it does.
template <typename Number>
std::optional<Number> ReadNumber(std::string_view data, size_t at, std::endian order) {
  static_assert(std::is_arithmetic_v<Number>);
  if (at > data.size() || data.size() - at < sizeof(Number)) return std::nullopt;
  unsigned char bytes[sizeof(Number)];
  std::memcpy(bytes, data.data() + at, sizeof bytes);
  if (order != std::endian::native) {
    for (size_t i = 0; i < sizeof bytes / 2; ++i) {
      const unsigned char byte = bytes[i];
      bytes[i] = bytes[sizeof bytes - 1 - i];
      bytes[sizeof bytes - 1 - i] = byte;
    }
  }
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

/// Appends a number, little endian.
template <typename Number>
void AppendLittleEndian(Number number, std::string* data) {
  static_assert(std::is_arithmetic_v<Number> && std::endian::native == std::endian::little);
  data->append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace orb360
