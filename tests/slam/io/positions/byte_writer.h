#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <string>

namespace orb360 {

/// Appends a number in the given order of bytes.
template <typename Number>
void Append(std::string* bytes, Number number, std::endian order = std::endian::big) {
  char buffer[sizeof(Number)];
  std::memcpy(buffer, &number, sizeof buffer);
  for (size_t i = 0; i < sizeof buffer; ++i) {
    *bytes += buffer[order == std::endian::native ? i : sizeof buffer - 1 - i];
  }
}

}  // namespace orb360
