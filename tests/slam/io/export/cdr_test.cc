#include "slam/io/export/cdr.h"

#include <string>

#include <gtest/gtest.h>

#include "slam/io/crc32.h"

namespace orb360 {
namespace {

using std::string_literals::operator""s;

TEST(Cdr, FieldsAreAlignedToTheirSizeFromTheEndOfTheHeader) {
  CdrWriter cdr;
  cdr.Write<std::uint8_t>(1);
  cdr.Write<std::uint16_t>(0x0203);
  cdr.Write<std::uint8_t>(4);
  cdr.Write<double>(-2);  // 8 bytes behind the header, 12 in the message
  cdr.Write<std::uint8_t>(5);
  cdr.Write<std::int32_t>(-1);
  EXPECT_EQ(cdr.Take(),
            "\0\1\0\0"
            "\1\0\3\2\4\0\0\0"
            "\0\0\0\0\0\0\0\xc0"
            "\5\0\0\0\xff\xff\xff\xff"s);
}

TEST(Cdr, TextEndsWithAZeroAndSequencesBeginWithTheirNumber) {
  CdrWriter cdr;
  cdr.WriteText("map");
  cdr.WriteText("");
  cdr.WriteBytes("\x09\x08"s);
  cdr.WriteCount(2);
  EXPECT_EQ(cdr.Take(),
            "\0\1\0\0"
            "\4\0\0\0map\0"
            "\1\0\0\0\0\0\0\0"
            "\2\0\0\0\x09\x08\0\0"
            "\2\0\0\0"s);
}

TEST(Crc32, IsThatOfIso3309AndContinues) {
  EXPECT_EQ(Crc32(""), 0U);
  EXPECT_EQ(Crc32("123456789"), 0xCBF43926U);  // the check value of CRC catalogues
  EXPECT_EQ(Crc32("6789", Crc32("12345")), 0xCBF43926U);
}

}  // namespace
}  // namespace orb360
