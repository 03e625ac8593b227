#pragma once

#include <filesystem>

namespace orb360 {

/// A folder on disk for as long as the object lives.
class TemporaryFolder {
 public:
  /// Creates the folder and removes what a killed run left in it. Throws UserError if it cannot be
  /// written.
  explicit TemporaryFolder(std::filesystem::path path);
  /// Removes the folder.
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  const std::filesystem::path path_;
};

}  // namespace orb360
