#include "slam/io/json_text.h"

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(ToJsonText, NamesThatAreNoUtf8DoNotEndAProgram) {
  const nlohmann::json json = {{"input",
                                "stra\xdf"
                                "e.gpx"},
                               {"frames", 3}};
  const nlohmann::json back = nlohmann::json::parse(ToJsonText(json, 2));
  EXPECT_EQ(back["input"],
            "stra\xef\xbf\xbd"
            "e.gpx");
  EXPECT_EQ(back["frames"], 3);
  EXPECT_EQ(ToJsonText(nlohmann::json("\xc3\x9f")), "\"\xc3\x9f\"") << "UTF-8 stays as it is";
}

}  // namespace
}  // namespace orb360
