#include "slam/io/tiff.h"

namespace orb360 {

std::optional<Tiff> OpenTiff(std::string_view data) {
  constexpr std::uint16_t kMagic = 42;
  const bool is_little = data.starts_with("II");
  if (!is_little && !data.starts_with("MM")) return std::nullopt;
  const Tiff tiff{data, is_little ? std::endian::little : std::endian::big};
  if (tiff.At<std::uint16_t>(2) != kMagic) return std::nullopt;
  return tiff;
}

std::optional<size_t> FirstDirectory(const Tiff& tiff) { return tiff.At<std::uint32_t>(4); }

std::optional<TiffEntry> FindEntry(const Tiff& tiff, size_t directory, std::uint16_t tag) {
  constexpr size_t kEntrySize = 12;
  constexpr size_t kFieldSize = 4;  // of a value that stands in the entry itself
  const std::optional<std::uint16_t> count = tiff.At<std::uint16_t>(directory);
  if (!count) return std::nullopt;
  for (size_t i = 0; i < *count; ++i) {
    const size_t at = directory + 2 + i * kEntrySize;
    const std::optional<std::uint32_t> field = tiff.At<std::uint32_t>(at + 8);
    if (!field) return std::nullopt;
    if (tiff.At<std::uint16_t>(at) != tag) continue;
    TiffEntry entry{static_cast<TiffType>(*tiff.At<std::uint16_t>(at + 2)),
                    *tiff.At<std::uint32_t>(at + 4), at + 8};
    const size_t element = entry.type == TiffType::kRational ? 8
                           : entry.type == TiffType::kLong   ? 4
                                                             : 1;
    if (element * entry.count > kFieldSize) entry.value = *field;
    return entry;
  }
  return std::nullopt;
}

std::optional<size_t> FindDirectory(const Tiff& tiff, size_t directory, std::uint16_t tag) {
  const std::optional<TiffEntry> entry = FindEntry(tiff, directory, tag);
  if (!entry || entry->type != TiffType::kLong || entry->count != 1) return std::nullopt;
  return tiff.At<std::uint32_t>(entry->value);
}

std::string_view FindText(const Tiff& tiff, size_t directory, std::uint16_t tag) {
  const std::optional<TiffEntry> entry = FindEntry(tiff, directory, tag);
  if (!entry || entry->type != TiffType::kAscii || entry->value > tiff.data.size() ||
      entry->count > tiff.data.size() - entry->value) {
    return {};
  }
  const std::string_view text = tiff.data.substr(entry->value, entry->count);
  return text.substr(0, text.find('\0'));
}

std::optional<double> FindFraction(const Tiff& tiff, size_t directory, std::uint16_t tag,
                                   size_t count, size_t index) {
  const std::optional<TiffEntry> entry = FindEntry(tiff, directory, tag);
  if (!entry || entry->type != TiffType::kRational || entry->count != count) return std::nullopt;
  const auto numerator = tiff.At<std::uint32_t>(entry->value + 8 * index);
  const auto denominator = tiff.At<std::uint32_t>(entry->value + 8 * index + 4);
  if (!numerator || !denominator || *denominator == 0) return std::nullopt;
  return static_cast<double>(*numerator) / *denominator;
}

}  // namespace orb360
