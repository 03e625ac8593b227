#include "slam/viewer/report_page.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/viewer/web_files.h"

namespace orb360 {
namespace {

using testing::HasSubstr;
using testing::Not;

size_t CountOf(const std::string& part, const std::string& text) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(ReportPage, IsOneFileWithAllThatThePageNeeds) {
  const std::string page = ReportPage("{\"a\": 1}", "octree", {{7, "jpeg", "range"}});
  EXPECT_THAT(page, HasSubstr(std::string(WebScript())));
  EXPECT_THAT(page, HasSubstr(std::string(WebStyle())));
  EXPECT_THAT(page, HasSubstr("id=\"embedded-run\">{\"a\": 1}</script>"));
  EXPECT_THAT(page, HasSubstr("id=\"embedded-octree\">b2N0cmVl</script>"));
  EXPECT_THAT(page, HasSubstr("id=\"embedded-image-7\">anBlZw==</script>"));
  EXPECT_THAT(page, HasSubstr("id=\"embedded-range-7\">cmFuZ2U=</script>"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr("viewer.js\"")));
  EXPECT_THAT(page, Not(HasSubstr("viewer.css\"")));
}

TEST(ReportPage, IsNotEndedByTextsOfTheRun) {
  const std::string page =
      ReportPage("{\"input\": \"</script><script>alert(1)</script>\"}", "", {});
  EXPECT_THAT(page, HasSubstr("\\u003c/script>\\u003cscript>alert(1)"));
  EXPECT_THAT(page, Not(HasSubstr("id=\"embedded-octree\"")));
  // The scene and the script of the page.
  EXPECT_EQ(CountOf("<script", page), 2U);
  EXPECT_EQ(CountOf("</script", page), 2U);
}

}  // namespace
}  // namespace orb360
