#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace orb360::town {

/// Returns a seed, an integer of at most 18 digits, or nothing if the text is none.
std::optional<uint64_t> ParseSeed(std::string_view text);

/// As above, but throws UserError for "unknown `what`" if the text is none.
uint64_t RequireSeed(std::string_view what, std::string_view text);

}  // namespace orb360::town
