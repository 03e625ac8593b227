#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace orb360 {

/// Parses the whole of `text` as a number, independent of the locale. Returns nullopt if it is not
/// a number or is out of Number's range. A leading plus is accepted.
template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Returns a number with so many decimals, independent of the locale.
inline std::string ToFixedText(double number, int decimals) {
  char buffer[400];  // A double has up to 309 digits before the point.
  // Adding zero turns -0 into 0.
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, number + 0.0,
                                          std::chars_format::fixed, decimals);
  return {buffer, end};
}

/// Returns the shortest text that ParseNumber reads back to the same number.
template <typename Number>
std::string ToText(Number number) {
  char buffer[32];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, number);
  return {buffer, end};
}

}  // namespace orb360
