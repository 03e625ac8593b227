#include "apps/town/import/file_bytes.h"

#include <fstream>
#include <iterator>
#include <system_error>

#include <orb360/nn/base/check.h>

namespace orb360::town {

FileBytes::FileBytes(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw UserError(name_ + ": no such file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UserError(name_ + ": cannot be opened");
  bytes_.assign(std::istreambuf_iterator<char>(file), {});
}

void FileBytes::Refuse(const std::string& reason) const { throw UserError(name_ + ": " + reason); }

std::span<const uint8_t> FileBytes::From(size_t offset, size_t count) const {
  if (offset > bytes_.size() || count > bytes_.size() - offset)
    Refuse("is damaged: it ends too early: unpack or copy it again");
  return {reinterpret_cast<const uint8_t*>(bytes_.data()) + offset, count};
}

std::string_view FileBytes::Text(size_t offset, size_t count) const {
  const std::span<const uint8_t> bytes = From(offset, count);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

uint32_t FileBytes::Word(size_t offset, size_t count) const {
  uint32_t word = 0;
  const std::span<const uint8_t> bytes = From(offset, count);
  for (size_t i = count; i-- > 0;) word = word << 8 | bytes[i];
  return word;
}

}  // namespace orb360::town
