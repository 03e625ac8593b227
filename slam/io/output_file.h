#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace orb360 {

/// A file being written, without a buffer of its own: what Write has taken survives the end of the
/// process, however it ends. Every failure (no such folder, no permission, disk full) is a
/// UserError of one line.
class OutputFile {
 public:
  enum class Mode { kReplace, kAppend };

  /// Creates the file; empties the one that is there, or goes on at its end.
  explicit OutputFile(std::filesystem::path path, Mode mode = Mode::kReplace);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void Write(std::string_view data);
  /// Writes over what stands at `offset` (bytes from the beginning); Write goes on where it was.
  void Overwrite(std::int64_t offset, std::string_view data);
  /// Waits until all that was written is on the disk, and closes.
  void SyncAndClose();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// Throws the UserError for a failed attempt to write `path`, by the value of errno.
[[noreturn]] void ThrowWriteError(const std::filesystem::path& path, int error);

}  // namespace orb360
