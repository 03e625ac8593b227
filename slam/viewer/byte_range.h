#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace orb360 {

/// Bytes of a resource, from `begin` to before `end`.
struct ByteRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

/// Reads the value of a Range header (RFC 9110, 14.1.2) for a resource of `size` bytes: one range
/// `bytes=FIRST-LAST`, `bytes=FIRST-` or `bytes=-COUNT`, cut off at the end of the resource. None
/// for one that has no byte of the resource, for several ranges, and for anything else.
std::optional<ByteRange> ParseByteRange(std::string_view header, std::uint64_t size);

}  // namespace orb360
