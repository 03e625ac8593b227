#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace orb360 {

/// UTC of a calendar date and a time of day, seconds since 1970. Returns nullopt for a date that
/// does not exist, and for a time outside the day (a leap second is accepted).
std::optional<double> UtcSeconds(int year, int month, int day, int hour, int minute,
                                 double seconds);

/// Parses ISO 8601 as GPX and MP4 have it: `2025-03-14T07:00:00.5Z`, with any number of decimals or
/// none, and `Z`, `+hh:mm`, `-hh:mm` or nothing (UTC) behind. Returns seconds since 1970, or
/// nullopt for anything else.
std::optional<double> ParseIsoTime(std::string_view text);

/// The inverse of ParseIsoTime, with three decimals and `Z`. `seconds` must lie in the years 1 to
/// 9999; other times throw ContractError.
std::string FormatIsoTime(double seconds);

}  // namespace orb360
