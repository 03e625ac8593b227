#include "slam/io/base64.h"

#include <cstdint>

namespace orb360 {

std::string EncodeBase64(std::string_view data) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((data.size() + 2) / 3 * 4);
  for (size_t i = 0; i < data.size(); i += 3) {
    std::uint32_t bits = 0;  // 24 of three bytes
    for (size_t j = 0; j < 3; ++j) {
      bits = bits << 8 | (i + j < data.size() ? static_cast<std::uint8_t>(data[i + j]) : 0u);
    }
    for (size_t j = 0; j < 4; ++j) {
      text += i + j > data.size() ? '=' : kDigits[bits >> (18 - 6 * j) & 63u];
    }
  }
  return text;
}

}  // namespace orb360
