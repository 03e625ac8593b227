#include "slam/io/positions/insta360_trailer.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "slam/io/byte_number.h"

namespace orb360 {
namespace {

constexpr std::string_view kMagic = "8db42d694ccc418790edff439fe026bf";
constexpr size_t kFooterSize = 72;
constexpr size_t kRecordHeaderSize = 6;  // behind the record
constexpr size_t kIndexEntrySize = 10;
constexpr size_t kMeasurementSize = 53;
constexpr int kIndexKind = 0, kGpsKind = 7;
constexpr int kMaxRecords = 4096;  // Cameras write a dozen.
/// A day of ten measurements a second has 46 MB; a damaged size must not take more memory.
constexpr std::uint64_t kMaxRecordBytes = 64 << 20;

/// Bytes of the file, both counted from its beginning.
struct Extent {
  std::uint64_t begin = 0, end = 0;
};

template <typename Number>
std::optional<Number> NumberAt(std::string_view bytes, size_t at) {
  return ReadNumber<Number>(bytes, at, std::endian::little);
}

/// Returns those bytes, or fewer where the file ends or cannot be read.
std::string ReadExtent(std::istream& file, const Extent& extent) {
  std::string bytes(extent.end - extent.begin, '\0');
  file.clear();
  file.seekg(static_cast<std::streamoff>(extent.begin));
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(file.gcount()));
  return bytes;
}

/// Where the records of a trailer are, with the header of the last one, or nullopt without trailer.
std::optional<Extent> FindRecords(std::istream& file) {
  file.clear();
  file.seekg(0, std::ios::end);
  const std::streamoff end = file.tellg();
  if (end < static_cast<std::streamoff>(kFooterSize)) return std::nullopt;
  const auto size = static_cast<std::uint64_t>(end);
  const std::string footer = ReadExtent(file, {size - kFooterSize, size});
  if (!footer.ends_with(kMagic)) return std::nullopt;
  const auto trailer_size = NumberAt<std::uint32_t>(footer, 32);
  if (!trailer_size || *trailer_size > size || *trailer_size < kFooterSize) return std::nullopt;
  return Extent{size - *trailer_size, size - kFooterSize};
}

/// The entry of an index that tells where the positions are.
std::optional<Extent> FindInIndex(std::string_view index, const Extent& records) {
  for (size_t at = 0; at + kIndexEntrySize <= index.size(); at += kIndexEntrySize) {
    const std::uint64_t size = *NumberAt<std::uint32_t>(index, at + 2);
    const std::uint64_t begin = records.begin + *NumberAt<std::uint32_t>(index, at + 6);
    if (index[at] != kGpsKind || size == 0) continue;
    if (begin + size > records.end) return std::nullopt;
    return Extent{begin, begin + size};
  }
  return std::nullopt;
}

std::optional<Extent> FindGpsRecord(std::istream& file) {
  const std::optional<Extent> records = FindRecords(file);
  if (!records) return std::nullopt;
  std::uint64_t end = records->end;
  for (int i = 0; i < kMaxRecords && end >= records->begin + kRecordHeaderSize; ++i) {
    end -= kRecordHeaderSize;
    const std::string header = ReadExtent(file, {end, end + kRecordHeaderSize});
    const auto size = NumberAt<std::uint32_t>(header, 2);
    if (!size || *size > end - records->begin) return std::nullopt;
    const Extent record{end - *size, end};
    if (header[1] == kGpsKind) return record;
    if (header[1] == kIndexKind) {
      if (*size > kMaxRecordBytes) return std::nullopt;
      return FindInIndex(ReadExtent(file, record), *records);
    }
    end = record.begin;
  }
  return std::nullopt;
}

/// Nullopt where letters that must be there are not.
std::optional<GeodeticFix> ParseFix(std::string_view measurement) {
  const char north = measurement[19], east = measurement[28];
  // French cameras write `O` for west.
  if ((north != 'N' && north != 'S') || (east != 'E' && east != 'W' && east != 'O')) {
    return std::nullopt;
  }
  GeodeticFix fix;
  fix.timestamp = static_cast<double>(*NumberAt<std::uint64_t>(measurement, 0)) +
                  1e-3 * *NumberAt<std::uint16_t>(measurement, 8);
  const double latitude = std::abs(*NumberAt<double>(measurement, 11));
  const double longitude = std::abs(*NumberAt<double>(measurement, 20));
  fix.latitude = north == 'N' ? latitude : -latitude;
  fix.longitude = east == 'E' ? longitude : -longitude;
  fix.altitude = *NumberAt<double>(measurement, 45);
  return IsPlausible(fix) ? std::optional(fix) : std::nullopt;
}

}  // namespace

Insta360Positions ReadInsta360Positions(std::istream& file) {
  Insta360Positions positions;
  const std::optional<Extent> record = FindGpsRecord(file);
  if (!record || record->end - record->begin > kMaxRecordBytes) return positions;
  const std::string bytes = ReadExtent(file, *record);
  for (size_t at = 0; at + kMeasurementSize <= bytes.size(); at += kMeasurementSize) {
    const std::string_view measurement = std::string_view(bytes).substr(at, kMeasurementSize);
    if (measurement[10] != 'A') {
      ++positions.num_without_lock;
    } else if (const std::optional<GeodeticFix> fix = ParseFix(measurement)) {
      positions.fixes.push_back(*fix);
    }
  }
  return positions;
}

}  // namespace orb360
