#include "slam/io/positions/utc_time.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kSecondsPerDay = 86400;

/// Takes `length` digits and the character `after` (none: 0) from the front of `text`.
std::optional<int> TakeDigits(std::string_view* text, size_t length, char after) {
  if (text->size() < length + (after != 0 ? 1 : 0)) return std::nullopt;
  int number = 0;
  for (const char c : text->substr(0, length)) {
    if (c < '0' || c > '9') return std::nullopt;
    number = 10 * number + (c - '0');
  }
  if (after != 0 && (*text)[length] != after) return std::nullopt;
  text->remove_prefix(length + (after != 0 ? 1 : 0));
  return number;
}

/// Seconds by which the local time with this zone is ahead of UTC: "", "Z", "+02:00", "-0530".
std::optional<double> ZoneSeconds(std::string_view zone) {
  if (zone.empty() || zone == "Z" || zone == "z") return 0.0;
  const double sign = zone.front() == '-' ? -1 : 1;
  if (zone.front() != '+' && zone.front() != '-') return std::nullopt;
  zone.remove_prefix(1);
  const std::optional<int> hours = TakeDigits(&zone, 2, zone.size() == 5 ? ':' : '\0');
  const std::optional<int> minutes = TakeDigits(&zone, 2, 0);
  if (!hours || !minutes || !zone.empty() || *hours > 14 || *minutes > 59) return std::nullopt;
  return sign * (3600.0 * *hours + 60.0 * *minutes);
}

}  // namespace

std::optional<double> UtcSeconds(int year, int month, int day, int hour, int minute,
                                 double seconds) {
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  const bool is_time =
      hour >= 0 && hour < 24 && minute >= 0 && minute < 60 && seconds >= 0 && seconds < 61;
  if (!date.ok() || !is_time) return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return kSecondsPerDay * static_cast<double>(days) + 3600.0 * hour + 60.0 * minute + seconds;
}

std::optional<double> ParseIsoTime(std::string_view text) {
  const std::optional<int> year = TakeDigits(&text, 4, '-');
  const std::optional<int> month = year ? TakeDigits(&text, 2, '-') : std::nullopt;
  const std::optional<int> day = month ? TakeDigits(&text, 2, 0) : std::nullopt;
  if (!day || text.empty() || (text.front() != 'T' && text.front() != ' ')) return std::nullopt;
  text.remove_prefix(1);
  const std::optional<int> hour = TakeDigits(&text, 2, ':');
  const std::optional<int> minute = hour ? TakeDigits(&text, 2, ':') : std::nullopt;
  if (!minute) return std::nullopt;
  const size_t end = std::min(text.find_first_not_of("0123456789."), text.size());
  const std::optional<double> seconds =
      end >= 2 ? ParseNumber<double>(text.substr(0, end)) : std::nullopt;
  const std::optional<double> zone = ZoneSeconds(text.substr(end));
  if (!seconds || !zone) return std::nullopt;
  const std::optional<double> local = UtcSeconds(*year, *month, *day, *hour, *minute, *seconds);
  if (!local) return std::nullopt;
  return *local - *zone;
}

std::string FormatIsoTime(double seconds) {
  const double rounded = std::round(1000 * seconds);  // milliseconds
  const double first = -62135596800e3;                // 0001-01-01
  const double last = 253402300799999.0;              // 9999-12-31T23:59:59.999
  ORB360_CHECK(rounded >= first && rounded <= last, seconds);
  const auto total = static_cast<std::int64_t>(rounded);
  const std::chrono::sys_time<std::chrono::milliseconds> time{std::chrono::milliseconds(total)};
  const auto midnight = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(midnight);
  const auto of_day = static_cast<int>((time - midnight).count());
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), of_day / 3600000, of_day / 60000 % 60,
                of_day / 1000 % 60, of_day % 1000);
  return buffer;
}

}  // namespace orb360
