#include "slam/io/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

namespace orb360 {
namespace {

std::filesystem::path TemporaryName(std::filesystem::path path) { return path += ".tmp"; }

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_(std::move(path)), temporary_(TemporaryName(path_)) {}

AtomicFile::~AtomicFile() {
  if (is_committed_) return;
  std::error_code ignored;
  std::filesystem::remove(temporary_.path(), ignored);
}

void AtomicFile::Commit() {
  temporary_.SyncAndClose();
  if (std::rename(temporary_.path().c_str(), path_.c_str()) != 0) ThrowWriteError(path_, errno);
  is_committed_ = true;
}

void WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  AtomicFile file(path);
  file.Write(content);
  file.Commit();
}

}  // namespace orb360
