#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orb360::town {

/// The bytes of a binary file; numbers are little-endian. Reading beyond the end throws UserError.
class FileBytes {
 public:
  /// Reads the whole file. Throws UserError if it cannot be opened.
  explicit FileBytes(const std::filesystem::path& path);

  /// Throws UserError that begins with the file.
  [[noreturn]] void Refuse(const std::string& reason) const;
  size_t size() const { return bytes_.size(); }
  std::span<const uint8_t> From(size_t offset, size_t count) const;
  std::string_view Text(size_t offset, size_t count) const;
  uint8_t Byte(size_t offset) const { return From(offset, 1)[0]; }
  uint32_t Word(size_t offset, size_t count = 4) const;
  int32_t Int(size_t offset) const { return static_cast<int32_t>(Word(offset)); }
  float Float(size_t offset) const { return std::bit_cast<float>(Word(offset)); }

 private:
  std::string name_;
  std::vector<char> bytes_;
};

}  // namespace orb360::town
