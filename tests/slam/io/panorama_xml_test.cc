#include "slam/io/panorama_xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(PanoramaXml, ValuesAreElementsOrAttributes) {
  EXPECT_EQ(XmlValue("<r><N:Key> a b\n</N:Key></r>", "N:Key"), "a b");
  EXPECT_EQ(XmlValue("<r N:KeyLonger=\"no\" N:Key = '7' />", "N:Key"), "7");
  EXPECT_EQ(XmlValue("<N:Key", "N:Key"), std::nullopt);
  EXPECT_EQ(XmlValue("text N:Key text", "N:Key"), std::nullopt);
  EXPECT_EQ(XmlValue("<N:KeyLonger>1</N:KeyLonger>", "N:Key"), std::nullopt);
}

const char* const kCropped =
    "<rdf:Description GPano:ProjectionType=\"equirectangular\" "
    "GPano:CroppedAreaImageWidthPixels=\"1000\" GPano:CroppedAreaImageHeightPixels=\"500\" "
    "GPano:FullPanoWidthPixels=\"4000\" GPano:FullPanoHeightPixels=\"2000\" "
    "GPano:CroppedAreaLeftPixels=\"1500\" GPano:CroppedAreaTopPixels=\"1000\"/>";

TEST(PanoramaXml, TheCropIsWhatIsMissing) {
  const PanoramaMetadata metadata = ReadPanoramaXml("a.jpg", kCropped, "GPano").value();
  EXPECT_TRUE(metadata.is_equirectangular);
  const PanoramaMetadata::Crop expected{0.375, 0.5, 0.375, 0.25};
  EXPECT_EQ(metadata.crop, expected);
  EXPECT_FALSE(ReadPanoramaXml("a.jpg", kCropped, "GSpherical"));
}

TEST(PanoramaXml, RefusesWhatCannotBe) {
  const auto refusal = [](std::string xml, const std::string& from, const std::string& to) {
    xml.replace(xml.find(from), from.size(), to);
    return MessageOf<UserError>([&] { ReadPanoramaXml("a.jpg", xml, "GPano"); });
  };
  EXPECT_THAT(refusal(kCropped, "\"1500\"", "\"3500\""),
              AllOf(HasSubstr("a.jpg"), HasSubstr("outside of the full panorama")));
  EXPECT_THAT(refusal(kCropped, "\"1500\"", "\"many\""),
              AllOf(HasSubstr("CroppedAreaLeftPixels"), HasSubstr("`many`")));
  EXPECT_THAT(refusal(kCropped, "equirectangular", "cylindrical"), HasSubstr("`cylindrical`"));
}

}  // namespace
}  // namespace orb360
