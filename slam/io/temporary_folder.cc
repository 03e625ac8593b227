#include "slam/io/temporary_folder.h"

#include <system_error>
#include <utility>

#include "slam/io/output_file.h"

namespace orb360 {

TemporaryFolder::TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
  if (!error) std::filesystem::create_directories(path_, error);
  if (error) ThrowWriteError(path_, error.value());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace orb360
