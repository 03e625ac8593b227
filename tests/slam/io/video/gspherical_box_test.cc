#include "slam/io/video/gspherical_box.h"

#include <cstdint>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

std::string Box(const std::string& type, const std::string& content) {
  const auto size = static_cast<std::uint32_t>(content.size() + 8);
  std::string box;
  for (int shift = 24; shift >= 0; shift -= 8) box += static_cast<char>(size >> shift);
  return box + type + content;
}

std::string LongBox(const std::string& type, const std::string& content) {
  std::string box("\0\0\0\1", 4);
  box += type;
  for (int shift = 56; shift >= 0; shift -= 8) {
    box += static_cast<char>((content.size() + 16) >> shift);
  }
  return box + content;
}

const std::string kUuid("\xff\xcc\x82\x63\xf8\x55\x4a\x93\x88\x14\x58\x7a\x02\x52\x1f\xdd", 16);

std::string Track(const std::string& handler, const std::string& rest) {
  return Box("trak", Box("tkhd", "x") +
                         Box("mdia", Box("hdlr", std::string(8, '\0') + handler + "....")) + rest);
}

std::optional<std::string> Find(const std::string& bytes, int number) {
  std::istringstream file(bytes);
  return FindGSphericalXml(file, number);
}

TEST(GSphericalBox, IsFoundInItsTrackAmongOthers) {
  const std::string movie =
      Box("ftyp", "isom") + LongBox("mdat", "frames") +
      Box("moov", Track("soun", Box("uuid", kUuid + "sound")) + Track("vide", "") +
                      Track("vide", Box("uuid", std::string(16, 'u') + "other") +
                                        Box("uuid", kUuid + "<xml/>")));
  EXPECT_EQ(Find(movie, 0), std::nullopt);
  EXPECT_EQ(Find(movie, 1), "<xml/>");
  EXPECT_EQ(Find(movie, 2), std::nullopt);
}

TEST(GSphericalBox, EveryTruncatedFileIsRefusedOrComplete) {
  const std::string movie = Box("moov", Track("vide", Box("uuid", kUuid + "<xml/>")));
  for (size_t size = 0; size < movie.size(); ++size) {
    EXPECT_EQ(Find(movie.substr(0, size), 0), std::nullopt) << size;
  }
  EXPECT_EQ(Find(movie, 0), "<xml/>");
}

TEST(GSphericalBox, ASizeBeyondTheFileIsNotRead) {
  const std::string box = Box("uuid", kUuid + "<xml/>");
  std::string grown = box;
  grown[1] = '\x7f';
  EXPECT_EQ(Find(Box("moov", Track("vide", grown)), 0), std::nullopt);
}

}  // namespace
}  // namespace orb360
