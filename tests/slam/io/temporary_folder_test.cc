#include "slam/io/temporary_folder.h"

#include <fstream>
#include <optional>

#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(TemporaryFolder, IsEmptyAtFirstAndGoneAtTheEnd) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "work");
  std::ofstream(folder / "work" / "left by a killed run") << "data";
  std::optional<TemporaryFolder> work(std::in_place, folder / "work");
  EXPECT_EQ(work->path(), folder / "work");
  EXPECT_TRUE(std::filesystem::is_empty(work->path()));
  std::ofstream(work->path() / "file") << "data";
  work.reset();
  EXPECT_FALSE(std::filesystem::exists(folder / "work"));
}

TEST(TemporaryFolder, ThatCannotBeCreatedIsAnError) {
  const TempFolder folder;
  std::ofstream(folder / "file") << "data";
  EXPECT_THROW(TemporaryFolder(folder / "file" / "work"), UserError);
}

}  // namespace
}  // namespace orb360
