#include "slam/io/scale_file.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(ScaleFile, ReadsWhatItHasWritten) {
  const TempFolder folder;
  const std::vector<StampedScale> scales = {{0.5, 1.00123, 0.02}, {1700000000.25, 0.97, 0.3}};
  WriteScales(folder / "scale.txt", scales);
  const std::vector<StampedScale> read = ReadScales(folder / "scale.txt");
  ASSERT_EQ(read.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_DOUBLE_EQ(read[i].timestamp, scales[i].timestamp);
    EXPECT_NEAR(read[i].value, scales[i].value, 1e-5);
    EXPECT_NEAR(read[i].sigma, scales[i].sigma, 1e-6);
  }
  WriteScales(folder / "none.txt", {});
  EXPECT_TRUE(ReadScales(folder / "none.txt").empty());
}

TEST(ScaleFile, NamesTheLineThatIsWrong) {
  const TempFolder folder;
  for (const char* line : {"1.0 1.0", "1.0 0 0.1", "1.0 1.0 -0.1", "1.0 one 0.1", "1 1 1 1"}) {
    const std::string path = folder / "scale.txt";
    std::ofstream(path) << "# timestamp value sigma\n0 1 0.02\n" << line << '\n';
    try {
      ReadScales(path);
      ADD_FAILURE() << line;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find("scale.txt:3"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(ReadScales(folder / "missing.txt"), UserError);
}

}  // namespace
}  // namespace orb360
