#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace orb360 {

/// Takes one column from the front of what a fuzzer changes: its number of entries (16 bits) and
/// then their bytes. Returns false where `bytes` ends before. Columns one after the other stand for
/// the content of a file behind its digest.
template <typename Column>
bool TakeColumn(std::string_view* bytes, Column* column) {
  std::uint16_t count = 0;
  if (bytes->size() < sizeof count) return false;
  std::memcpy(&count, bytes->data(), sizeof count);
  bytes->remove_prefix(sizeof count);
  const std::size_t size = count * sizeof(*column)[0];
  if (bytes->size() < size) return false;
  column->resize(count);
  if (count > 0) std::memcpy(column->data(), bytes->data(), size);
  bytes->remove_prefix(size);
  return true;
}

template <typename Column>
void AppendColumn(const Column& column, std::string* bytes) {
  const auto count = static_cast<std::uint16_t>(column.size());
  bytes->append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes->append(reinterpret_cast<const char*>(column.data()), count * sizeof column[0]);
}

/// Takes all columns of the arrays that a file holds (ForEachColumn).
template <typename Arrays>
std::optional<Arrays> ReadColumnsInput(std::string_view bytes) {
  Arrays arrays;
  bool is_whole = true;
  ForEachColumn(arrays, [&](const char*, auto& column, int) {
    is_whole = is_whole && TakeColumn(&bytes, &column);
  });
  if (!is_whole) return std::nullopt;
  return arrays;
}

template <typename Arrays>
std::string WriteColumnsInput(const Arrays& arrays) {
  std::string bytes;
  ForEachColumn(arrays,
                [&](const char*, const auto& column, int) { AppendColumn(column, &bytes); });
  return bytes;
}

}  // namespace orb360
