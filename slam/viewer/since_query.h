#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace orb360 {

/// Reads the query of a request, `since=N` with a number of digits: the revision of what a page has
/// already. 0 for an empty query, none for any other.
std::optional<std::uint64_t> ParseSince(std::string_view query);

}  // namespace orb360
