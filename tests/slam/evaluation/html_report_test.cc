#include "slam/evaluation/html_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace orb360 {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(HtmlReport, Base64IsThatOfRfc4648) {
  EXPECT_EQ(EncodeBase64(""), "");
  EXPECT_EQ(EncodeBase64("f"), "Zg==");
  EXPECT_EQ(EncodeBase64("fo"), "Zm8=");
  EXPECT_EQ(EncodeBase64("foo"), "Zm9v");
  EXPECT_EQ(EncodeBase64("foob"), "Zm9vYg==");
  EXPECT_EQ(EncodeBase64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(EncodeBase64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(EncodeBase64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(HtmlReport, PngGivesTheImageBack) {
  cv::Mat image(5, 7, CV_8UC3);
  cv::randu(image, 0, 256);
  const std::string png = EncodePng(image);
  const cv::Mat read =
      cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
  EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0);
}

TEST(HtmlReport, HasAllPartsAndNeedsNoOtherFile) {
  HtmlReport report;
  report.title = "drive.mp4";
  report.subtitle = "made by <script>";
  report.tiles = {{"99 %", "tracked"}};
  report.warnings = {"frame 3 & 4 damaged"};
  report.images = {{"Cloud", "from \"above\"", "foobar", "image/png"}};
  report.bars_title = "Time";
  report.bars = {{"extract", 5.0, 10.0}, {"track", 2.5, 20.0}};
  report.table_title = "Files";
  report.table = {{"cloud.ply", "the cloud"}};
  const std::string html = MakeHtml(report);
  for (const char* part :
       {"<h1>drive.mp4</h1>", "made by &lt;script&gt;", "99 %", "frame 3 &amp; 4 damaged",
        "src=\"data:image/png;base64,Zm9vYmFy\"", "from &quot;above&quot;", "width:25.0%",
        "width:50.0%", "width:12.5%", "width:100.0%", "cloud.ply"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("http")));
}

}  // namespace
}  // namespace orb360
