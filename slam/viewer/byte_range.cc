#include "slam/viewer/byte_range.h"

#include <algorithm>

#include "slam/viewer/digits.h"

namespace orb360 {
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
