#include "slam/io/positions/file_head.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

size_t SizeOf(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw UserError(path.string() + (std::filesystem::exists(path, error)
                                         ? ": is not a file"
                                         : ": no such file or folder"));
  }
  const auto size = static_cast<size_t>(std::filesystem::file_size(path, error));
  if (!error && size == 0) throw UserError(path.string() + ": is empty (0 bytes)");
  return error ? 0 : size;
}

}  // namespace

std::string ReadFileHead(const std::filesystem::path& path, size_t max_bytes) {
  std::string data(std::min(SizeOf(path), max_bytes), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(data.data(), static_cast<std::streamsize>(data.size())) || data.empty()) {
    throw UserError(path.string() + ": cannot be read; check its permissions and the disk");
  }
  return data;
}

std::string ReadWholeFile(const std::filesystem::path& path, size_t max_bytes) {
  const size_t size = SizeOf(path);
  if (size > max_bytes) {
    throw UserError(path.string() + ": has " + std::to_string(size >> 20) + " MiB, more than the " +
                    std::to_string(max_bytes >> 20) + " that are read; cut it to the recording");
  }
  return ReadFileHead(path, max_bytes);
}

}  // namespace orb360
