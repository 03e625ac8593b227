#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "slam/io/byte_number.h"

namespace orb360 {

/// Serializes a message as ROS 2 does: plain CDR, little endian (OMG DDS-XTypes 1.3, 7.4.1, version
/// 1 of the encoding). Fields are written one after the other in the order of the message's
/// definition, each aligned to its size from the end of the four bytes that name the encoding.
class CdrWriter {
 public:
  template <typename Number>
  void Write(Number number) {
    const size_t excess = (bytes_.size() - kHeaderBytes) % sizeof number;
    if (excess > 0) bytes_.append(sizeof number - excess, '\0');
    AppendLittleEndian(number, &bytes_);
  }
  /// A string: its length with the zero behind it, and both.
  void WriteText(std::string_view text) {
    WriteCount(text.size() + 1);
    bytes_ += text;
    bytes_ += '\0';
  }
  /// The number of elements of a sequence, which follow.
  void WriteCount(size_t count) { Write(static_cast<std::uint32_t>(count)); }
  /// A sequence of bytes.
  void WriteBytes(std::string_view bytes) {
    WriteCount(bytes.size());
    bytes_ += bytes;
  }

  /// Returns the message.
  std::string Take() { return std::move(bytes_); }

 private:
  static constexpr size_t kHeaderBytes = 4;

  std::string bytes_{"\0\1\0\0", kHeaderBytes};  // CDR_LE
};

}  // namespace orb360
