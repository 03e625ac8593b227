#include "apps/town/import/sgi_image.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

class SgiImageTest : public testing::Test {
 protected:
  ~SgiImageTest() override { std::filesystem::remove(path_); }

  void Write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  cv::Mat4b Read() const { return ReadSgiImage(path_); }

  /// The header of an image of 3 x 2 pixels.
  static std::string Header(bool is_packed, char channels) {
    std::string header(512, '\0');
    header.replace(0, 12,
                   std::string{1, static_cast<char>(218), static_cast<char>(is_packed ? 1 : 0), 1,
                               0, 3, 0, 3, 0, 2, 0, channels});
    return header;
  }

  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("sgi_test_" + std::to_string(getpid()) + ".rgb");
};

TEST_F(SgiImageTest, VerbatimRowsRunFromBelow) {
  // Red, green and blue planes, the lower row first.
  Write(Header(false, 3) + "abc" + "def" + "ghi" + "jkl" + "mno" + "pqr");
  const cv::Mat4b image = Read();
  ASSERT_EQ(image.size(), cv::Size(3, 2));
  EXPECT_EQ(image(1, 0), cv::Vec4b('m', 'g', 'a', 255));
  EXPECT_EQ(image(0, 2), cv::Vec4b('r', 'l', 'f', 255));
}

TEST_F(SgiImageTest, RunsAreUnpacked) {
  // Grey and alpha: four rows, one after the other behind the tables.
  const std::string rows[4] = {std::string("\x83"
                                           "abc"
                                           "\0",
                                           5),
                               std::string("\x03"
                                           "x"
                                           "\0",
                                           3),
                               std::string("\x81"
                                           "p"
                                           "\x02"
                                           "q"
                                           "\0",
                                           5),
                               std::string("\x03"
                                           "r"
                                           "\0",
                                           3)};
  std::string starts;
  std::string lengths;
  std::string data;
  const auto number = [](size_t n) {
    return std::string{0, 0, static_cast<char>(n >> 8), static_cast<char>(n & 255)};
  };
  for (const std::string& row : rows) {
    starts += number(512 + 32 + data.size());
    lengths += number(row.size());
    data += row;
  }
  Write(Header(true, 2) + starts + lengths + data);
  const cv::Mat4b image = Read();
  EXPECT_EQ(image(1, 0), cv::Vec4b('a', 'a', 'a', 'p'));
  EXPECT_EQ(image(1, 2), cv::Vec4b('c', 'c', 'c', 'q'));
  EXPECT_EQ(image(0, 1), cv::Vec4b('x', 'x', 'x', 'r'));
}

TEST_F(SgiImageTest, NoTruncatedOrAlteredFileIsReadBeyondItsEnd) {
  const std::string good = Header(false, 3) + std::string(18, 'a');
  for (size_t size = 0; size < good.size(); ++size) {
    Write(good.substr(0, size));
    EXPECT_THROW(Read(), UserError) << size;
  }
  std::string packed = Header(true, 1) + std::string(16, '\x7f');  // rows far beyond the end
  Write(packed);
  EXPECT_THROW(Read(), UserError);
  packed = Header(true, 4) + std::string(16, '\0');
  packed.replace(6, 4, "\xff\xff\xff\xff");  // 65535 x 65535 pixels
  Write(packed);
  EXPECT_THROW(Read(), UserError);
  packed = good;
  packed[0] = 7;
  Write(packed);
  EXPECT_THROW(Read(), UserError);
}

}  // namespace
}  // namespace orb360::town
