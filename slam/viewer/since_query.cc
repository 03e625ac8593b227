#include "slam/viewer/since_query.h"

#include "slam/viewer/digits.h"

namespace orb360 {

std::optional<std::uint64_t> ParseSince(std::string_view query) {
  constexpr std::string_view kName = "since=";
  if (query.empty()) return 0;
  if (!query.starts_with(kName)) return std::nullopt;
  return ParseDigits(query.substr(kName.size()));
}

}  // namespace orb360
