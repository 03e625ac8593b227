#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "slam/io/byte_number.h"

namespace orb360 {

/// A TIFF structure as Exif has it (TIFF 6.0, section 2). Offsets count from its start. What lies
/// outside of the data is absent.
struct Tiff {
  std::string_view data;
  std::endian order = std::endian::little;

  template <typename Number>
  std::optional<Number> At(size_t at) const {
    return ReadNumber<Number>(data, at, order);
  }
};

/// Types of entries.
enum class TiffType : std::uint16_t { kByte = 1, kAscii = 2, kLong = 4, kRational = 5 };

/// An entry of a directory.
struct TiffEntry {
  TiffType type{};
  std::uint32_t count = 0;
  size_t value = 0;  ///< Offset of the value or, where it has up to four bytes, of its field.
};

/// Returns nullopt where the data do not begin with a header of TIFF.
std::optional<Tiff> OpenTiff(std::string_view data);

/// Returns the offset of the first directory.
std::optional<size_t> FirstDirectory(const Tiff& tiff);

/// Returns the entry with a tag in the directory at an offset.
std::optional<TiffEntry> FindEntry(const Tiff& tiff, size_t directory, std::uint16_t tag);

/// Returns the offset of the directory that the entry with a tag points to.
std::optional<size_t> FindDirectory(const Tiff& tiff, size_t directory, std::uint16_t tag);

/// Returns the text of an entry up to its first zero; empty where there is none.
std::string_view FindText(const Tiff& tiff, size_t directory, std::uint16_t tag);

/// Returns fraction `index` of an entry of `count` fractions; nullopt for another entry and for
/// x/0.
std::optional<double> FindFraction(const Tiff& tiff, size_t directory, std::uint16_t tag,
                                   size_t count, size_t index);

}  // namespace orb360
