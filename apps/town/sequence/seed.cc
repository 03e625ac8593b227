#include "apps/town/sequence/seed.h"

#include <charconv>
#include <string>

#include <orb360/nn/base/check.h>

namespace orb360::town {

std::optional<uint64_t> ParseSeed(std::string_view text) {
  constexpr size_t kMaximumDigits = 18;  // 10^18 < 2^63
  uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size() || text.size() > kMaximumDigits)
    return std::nullopt;
  return seed;
}

uint64_t RequireSeed(std::string_view what, std::string_view text) {
  const std::optional<uint64_t> seed = ParseSeed(text);
  if (seed) return *seed;
  throw UserError("unknown " + std::string(what) + " '" + std::string(text) +
                  "': use a seed of at most 18 digits");
}

}  // namespace orb360::town
