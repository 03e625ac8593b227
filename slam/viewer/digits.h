#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>

#include "nn/base/number_text.h"

namespace orb360 {

/// A number that consists of digits only, as in headers of HTTP. None for a sign, and where it does
/// not fit.
inline std::optional<std::uint64_t> ParseDigits(std::string_view text) {
  const bool is_digits =
      !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  return is_digits ? ParseNumber<std::uint64_t>(text) : std::nullopt;
}

}  // namespace orb360
