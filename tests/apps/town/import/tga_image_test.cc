#include "apps/town/import/tga_image.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "apps/town/import/texture_file.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using ::testing::HasSubstr;

class TgaImageTest : public testing::Test {
 protected:
  ~TgaImageTest() override { std::filesystem::remove(path_); }
  cv::Mat4b Read(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    return ReadTgaImage(path_);
  }
  std::string Problem(const std::string& bytes) const {
    try {
      Read(bytes);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  /// The header of an image of 3 x 2 pixels, and two bytes of text before the pixels.
  static std::string Header(char kind, char bits, char descriptor = 0) {
    std::string header(18, '\0');
    header[0] = 2;
    header[2] = kind;
    header[12] = 3;
    header[14] = 2;
    header[16] = bits;
    header[17] = descriptor;
    return header + "id";
  }

  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("tga_test_" + std::to_string(getpid()) + ".tga");
};

TEST_F(TgaImageTest, VerbatimRowsRunFromBelowUnlessTheHeaderSaysOtherwise) {
  const std::string pixels = "abcdefghijklmnopqr";
  const cv::Mat4b image = Read(Header(2, 24) + pixels);
  ASSERT_EQ(image.size(), cv::Size(3, 2));
  EXPECT_EQ(image(1, 0), cv::Vec4b('a', 'b', 'c', 255));
  EXPECT_EQ(image(0, 2), cv::Vec4b('p', 'q', 'r', 255));
  EXPECT_EQ(Read(Header(2, 24, 32) + pixels)(0, 0), cv::Vec4b('a', 'b', 'c', 255));
  EXPECT_EQ(Read(Header(2, 24, 48) + pixels)(0, 2), cv::Vec4b('a', 'b', 'c', 255));
  EXPECT_EQ(Read(Header(3, 8) + "abcdef")(1, 1), cv::Vec4b('b', 'b', 'b', 255));
}

TEST_F(TgaImageTest, RunsAreUnpackedAndCrossRows) {
  const cv::Mat4b image = Read(Header(10, 32) + "\x83" + "abcd" + "\x01" + "efghijkl");
  EXPECT_EQ(image(1, 2), cv::Vec4b('a', 'b', 'c', 'd'));
  EXPECT_EQ(image(0, 0), cv::Vec4b('a', 'b', 'c', 'd'));
  EXPECT_EQ(image(0, 1), cv::Vec4b('e', 'f', 'g', 'h'));
  EXPECT_EQ(image(0, 2), cv::Vec4b('i', 'j', 'k', 'l'));
}

TEST_F(TgaImageTest, AlphaIsNoHoleInAnOpaqueTexture) {
  const std::string clear = Header(2, 32) + std::string(24, '\0');
  std::ofstream(path_, std::ios::binary) << clear;
  EXPECT_FALSE(ReadTexture(path_, Alpha::kIgnored).has_holes);
  EXPECT_TRUE(ReadTexture(path_, Alpha::kCoverage).has_holes);
}

TEST_F(TgaImageTest, DamagedFilesAreRefused) {
  const std::string good = Header(10, 32) + "\x83" + "abcd" + "\x01" + "efghijkl";
  for (size_t length = 0; length < good.size(); ++length)
    EXPECT_THAT(Problem(good.substr(0, length)), HasSubstr(".tga: ")) << length;
  EXPECT_THAT(Problem(Header(10, 32) + "\xff" + "abcd"), HasSubstr("a run of pixels does not fit"));
  EXPECT_THAT(Problem(Header(1, 8) + "abcdef"), HasSubstr("is not read"));
  std::string huge = Header(2, 24);
  huge.replace(12, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(Problem(huge), HasSubstr("has a size that is not read"));
}

}  // namespace
}  // namespace orb360::town
