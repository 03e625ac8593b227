#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "slam/io/atomic_file.h"

namespace orb360 {

/// An AtomicFile that is written in small parts, which are collected to pieces of a megabyte, so
/// that a file of any size needs little memory. Throws UserError where the disk fails.
class ChunkedFile {
 public:
  explicit ChunkedFile(std::filesystem::path path) : file_(std::move(path)) {}

  void Write(std::string_view part) {
    buffer_ += part;
    if (buffer_.size() >= kChunkBytes) Flush();
  }
  /// Writes a number as it lies in memory, which is little endian.
  template <typename Number>
  void WriteBinary(Number number) {
    Write({reinterpret_cast<const char*>(&number), sizeof number});
  }
  /// Makes the file appear under its name.
  void Commit() {
    Flush();
    file_.Commit();
  }

 private:
  static constexpr size_t kChunkBytes = size_t{1} << 20;

  void Flush() {
    file_.Write(buffer_);
    buffer_.clear();
  }

  AtomicFile file_;
  std::string buffer_;
};

}  // namespace orb360
