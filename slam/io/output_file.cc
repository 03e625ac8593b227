#include "slam/io/output_file.h"

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <orb360/nn/base/check.h>

namespace orb360 {

void ThrowWriteError(const std::filesystem::path& path, int error) {
  const bool is_full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  throw UserError(path.string() + ": cannot be written: " + std::generic_category().message(error) +
                  (is_full ? "; free some space or choose another folder"
                           : "; choose a folder you can write to"));
}

OutputFile::OutputFile(std::filesystem::path path, Mode mode)
    : path_(std::move(path)),
      descriptor_(open(
          path_.c_str(),
          O_WRONLY | O_CREAT | O_CLOEXEC | (mode == Mode::kAppend ? O_APPEND : O_TRUNC), 0666)) {
  if (descriptor_ < 0) ThrowWriteError(path_, errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void OutputFile::Write(std::string_view data) {
  ORB360_CHECK(descriptor_ >= 0, path_);
  while (!data.empty()) {
    const ssize_t written = write(descriptor_, data.data(), data.size());
    if (written >= 0) {
      data.remove_prefix(static_cast<size_t>(written));
    } else if (errno != EINTR) {
      ThrowWriteError(path_, errno);
    }
  }
}

void OutputFile::Overwrite(std::int64_t offset, std::string_view data) {
  ORB360_CHECK(descriptor_ >= 0, path_);
  while (!data.empty()) {
    const ssize_t written = pwrite(descriptor_, data.data(), data.size(), offset);
    if (written >= 0) {
      data.remove_prefix(static_cast<size_t>(written));
      offset += written;
    } else if (errno != EINTR) {
      ThrowWriteError(path_, errno);
    }
  }
}

void OutputFile::SyncAndClose() {
  ORB360_CHECK(descriptor_ >= 0, path_);
  // EINVAL means that the file is a pipe or a device, which cannot be synced.
  if (fsync(descriptor_) != 0 && errno != EINVAL) ThrowWriteError(path_, errno);
  if (close(std::exchange(descriptor_, -1)) != 0) ThrowWriteError(path_, errno);
}

}  // namespace orb360
