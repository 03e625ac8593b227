#include "slam/viewer/web_files.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

using testing::HasSubstr;

TEST(WebFiles, AreThoseOfTheRepository) {
  const std::string folder = std::string(ORB360_SOURCE_DIR) + "/slam/viewer/web/dist/";
  EXPECT_EQ(WebPage(), ReadText(folder + "index.html"));
  EXPECT_EQ(WebScript(), ReadText(folder + "viewer.js"));
  EXPECT_EQ(WebStyle(), ReadText(folder + "viewer.css"));
  EXPECT_THAT(std::string(WebPage()), HasSubstr("<script src=\"viewer.js\">"));
  EXPECT_LT(WebScript().size() + WebStyle().size() + WebPage().size(), 1'500'000U);
}

TEST(WebFiles, FetchNothingFromElsewhere) {
  const std::string page(WebPage());
  EXPECT_THAT(page, testing::Not(HasSubstr("src=\"http")));
  EXPECT_THAT(page, testing::Not(HasSubstr("href=\"http")));
  EXPECT_THAT(std::string(WebStyle()), testing::Not(HasSubstr("@import")));
  EXPECT_THAT(std::string(WebStyle()), testing::Not(HasSubstr("url(")));
}

}  // namespace
}  // namespace orb360
