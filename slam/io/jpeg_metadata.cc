#include "slam/io/jpeg_metadata.h"

#include <chrono>
#include <cstdint>
#include <fstream>

#include "nn/base/number_text.h"
#include "slam/io/tiff.h"

namespace orb360 {
namespace {

constexpr std::string_view kExifHeader("Exif\0\0", 6);
constexpr std::string_view kXmpHeader("http://ns.adobe.com/xap/1.0/\0", 29);

/// Seconds for "YYYY:MM:DD HH:MM:SS", or nullopt.
std::optional<double> ParseTime(std::string_view text) {
  constexpr size_t kLength = 19;
  if (text.size() < kLength) return std::nullopt;
  const auto number = [&](size_t at, size_t size) {
    return ParseNumber<int>(text.substr(at, size)).value_or(-1);
  };
  namespace time = std::chrono;
  const time::year_month_day date(time::year(number(0, 4)), time::month(number(5, 2)),
                                  time::day(number(8, 2)));
  const int hour = number(11, 2);
  const int minute = number(14, 2);
  const int second = number(17, 2);
  const bool is_time = date.ok() && hour >= 0 && hour < 24 && minute >= 0 && minute < 60 &&
                       second >= 0 && second <= 60;
  if (!is_time) return std::nullopt;
  const double days = time::sys_days(date).time_since_epoch().count();
  return 86400.0 * days + 3600.0 * hour + 60.0 * minute + second;
}

}  // namespace

std::optional<double> ExifTime(std::string_view exif) {
  constexpr std::uint16_t kExifDirectory = 0x8769;
  constexpr std::uint16_t kDateTimeOriginal = 0x9003;
  constexpr std::uint16_t kSubSecTimeOriginal = 0x9291;
  const std::optional<Tiff> tiff = OpenTiff(exif);
  const std::optional<size_t> first = tiff ? FirstDirectory(*tiff) : std::nullopt;
  const std::optional<size_t> directory =
      first ? FindDirectory(*tiff, *first, kExifDirectory) : std::nullopt;
  if (!directory) return std::nullopt;
  std::optional<double> time = ParseTime(FindText(*tiff, *directory, kDateTimeOriginal));
  if (time) {
    std::string_view digits = FindText(*tiff, *directory, kSubSecTimeOriginal);
    digits = digits.substr(0, digits.find_first_not_of("0123456789"));
    *time += ParseNumber<double>("0." + std::string(digits)).value_or(0.0);
  }
  return time;
}

JpegMetadata ReadJpegMetadata(std::istream& file) {
  constexpr int kMaxSegments = 1000;  // of metadata; a damaged file could have empty ones alone
  constexpr unsigned kStartOfScan = 0xda;
  constexpr unsigned kApp1 = 0xe1;
  JpegMetadata metadata;
  char head[4] = {};
  if (!file.read(head, 2) || std::string_view(head, 2) != "\xff\xd8") return metadata;
  const auto byte = [&](int i) { return static_cast<unsigned char>(head[i]); };
  for (int i = 0; i < kMaxSegments && file.read(head, 4); ++i) {
    if (byte(0) != 0xff || byte(1) == kStartOfScan) break;
    const int size = (byte(2) << 8 | byte(3)) - 2;
    if (size < 0) break;
    if (byte(1) != kApp1) {
      file.seekg(size, std::ios::cur);
      continue;
    }
    std::string content(static_cast<size_t>(size), '\0');
    if (!file.read(content.data(), size)) break;
    if (content.starts_with(kExifHeader) && metadata.exif.empty()) {
      metadata.exif = content.substr(kExifHeader.size());
    } else if (content.starts_with(kXmpHeader)) {
      metadata.xmp = content.substr(kXmpHeader.size());
    }
  }
  return metadata;
}

JpegMetadata ReadJpegMetadata(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return ReadJpegMetadata(file);
}

}  // namespace orb360
