#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "slam/io/output_file.h"

namespace orb360 {

/// A file that appears under its name only when it is complete. It is written as `NAME.tmp` beside
/// the target, synced to the disk, and renamed. A reader finds either the old file or the whole new
/// one. Failures throw UserError and leave no temporary file.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  /// Without Commit, removes the temporary file and leaves the old file unchanged.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(std::string_view data) { temporary_.Write(data); }
  /// See OutputFile.
  void Overwrite(std::int64_t offset, std::string_view data) { temporary_.Overwrite(offset, data); }
  void Commit();

 private:
  std::filesystem::path path_;
  OutputFile temporary_;
  bool is_committed_ = false;
};

/// Writes a whole file through AtomicFile.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view content);

}  // namespace orb360
