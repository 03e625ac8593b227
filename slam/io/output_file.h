#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace orb360 {

/// A file that is written without a buffer of its own: data passed to Write survive the end of the
/// process, however it ends. Every failure (no such folder, no permission, full disk) throws
/// UserError with one line.
class OutputFile {
 public:
  enum class Mode { kReplace, kAppend };

  /// Creates the file. An existing file is emptied, or continued at its end.
  explicit OutputFile(std::filesystem::path path, Mode mode = Mode::kReplace);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void Write(std::string_view data);
  /// Overwrites the bytes from `offset` on. The position at which Write continues does not change.
  void Overwrite(std::int64_t offset, std::string_view data);
  /// Waits until all data are on the disk, and closes the file.
  void SyncAndClose();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// Throws the UserError for a failed attempt to write `path`, according to the value of errno.
[[noreturn]] void ThrowWriteError(const std::filesystem::path& path, int error);

}  // namespace orb360
