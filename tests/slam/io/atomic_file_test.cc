#include "slam/io/atomic_file.h"

#include <csignal>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using ::testing::HasSubstr;

int FilesIn(const TempFolder& folder) {
  int count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    ++count;
  }
  return count;
}

TEST(AtomicFile, TheOldFileStaysUntilTheNewOneIsFinished) {
  const TempFolder folder;
  WriteText(folder / "a.txt", "old");
  AtomicFile file(folder / "a.txt");
  file.Write("new ");
  file.Write("text");
  EXPECT_EQ(ReadText(folder / "a.txt"), "old");
  file.Commit();
  EXPECT_EQ(ReadText(folder / "a.txt"), "new text");
  EXPECT_EQ(FilesIn(folder), 1);
}

TEST(AtomicFile, WithoutCommitNothingHasHappened) {
  const TempFolder folder;
  { AtomicFile(folder / "a.txt").Write("new"); }
  EXPECT_EQ(FilesIn(folder), 0);
}

TEST(AtomicFile, AFolderThatIsNoneGivesOneLine) {
  const TempFolder folder;
  WriteText(folder / "file", "");
  for (const std::filesystem::path& path : {folder / "absent" / "a.txt", folder / "file" / "a.txt",
                                            std::filesystem::path("/proc/orb360/a.txt")}) {
    const std::string message = MessageOf<UserError>([&] { WriteFileAtomically(path, "text"); });
    EXPECT_THAT(message, HasSubstr(path.string()));
    EXPECT_THAT(message, HasSubstr("cannot be written"));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(AtomicFile, AFolderOfThatNameGivesOneLineAndLeavesNothing) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "a.txt");
  EXPECT_THAT(MessageOf<UserError>([&] { WriteFileAtomically(folder / "a.txt", "text"); }),
              HasSubstr("a.txt: cannot be written"));
  EXPECT_EQ(FilesIn(folder), 1);
}

TEST(AtomicFile, ADiskThatFillsUpGivesOneLineAndKeepsTheOldFile) {
  const TempFolder folder;
  WriteText(folder / "a.txt", "old");
  // A limit on file size stands in for the full disk.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto previous = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limited{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limited);
  const std::string message =
      MessageOf<UserError>([&] { WriteFileAtomically(folder / "a.txt", std::string(5000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, previous);
  EXPECT_THAT(message, HasSubstr("free some space"));
  EXPECT_EQ(ReadText(folder / "a.txt"), "old");
  EXPECT_EQ(FilesIn(folder), 1);
}

}  // namespace
}  // namespace orb360
