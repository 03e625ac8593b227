#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "slam/io/map_arrays.h"

namespace orb360 {

/// What the fuzzer changes: the columns of a map one after the other, each its number of entries
/// (16 bits) and then their bytes. It stands for the content of a map file behind the digest.
inline std::optional<MapArrays> ReadMapInput(std::string_view bytes) {
  MapArrays arrays;
  bool is_whole = true;
  ForEachColumn(arrays, [&](const char*, auto& column, int) {
    std::uint16_t count = 0;
    if (bytes.size() < sizeof count) is_whole = false;
    if (!is_whole) return;
    std::memcpy(&count, bytes.data(), sizeof count);
    bytes.remove_prefix(sizeof count);
    const std::size_t size = count * sizeof column[0];
    if (bytes.size() < size) is_whole = false;
    if (!is_whole) return;
    column.resize(count);
    if (count > 0) std::memcpy(column.data(), bytes.data(), size);
    bytes.remove_prefix(size);
  });
  if (!is_whole) return std::nullopt;
  return arrays;
}

inline std::string WriteMapInput(const MapArrays& arrays) {
  std::string bytes;
  ForEachColumn(arrays, [&](const char*, const auto& column, int) {
    const auto count = static_cast<std::uint16_t>(column.size());
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes.append(reinterpret_cast<const char*>(column.data()), count * sizeof column[0]);
  });
  return bytes;
}

}  // namespace orb360
