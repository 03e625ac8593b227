#include "slam/viewer/byte_range.h"

#include <algorithm>

#include "nn/base/number_text.h"

namespace orb360 {
namespace {

/// A number of digits only.
std::optional<std::uint64_t> ParseDigits(std::string_view text) {
  const bool is_digits =
      !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  return is_digits ? ParseNumber<std::uint64_t>(text) : std::nullopt;
}

}  // namespace

std::optional<ByteRange> ParseByteRange(std::string_view header, std::uint64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  if (!header.starts_with(kUnit)) return std::nullopt;
  header.remove_prefix(kUnit.size());
  const size_t dash = header.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const std::string_view first_text = header.substr(0, dash);
  const std::string_view last_text = header.substr(dash + 1);
  const std::optional<std::uint64_t> first = ParseDigits(first_text);
  const std::optional<std::uint64_t> last = ParseDigits(last_text);
  if (first_text.empty()) {  // the last bytes
    if (!last || *last == 0 || size == 0) return std::nullopt;
    return ByteRange{size - std::min(*last, size), size};
  }
  if (!first || *first >= size) return std::nullopt;
  if (last_text.empty()) return ByteRange{*first, size};
  if (!last || *last < *first) return std::nullopt;
  return ByteRange{*first, std::min(*last, size - 1) + 1};
}

}  // namespace orb360
