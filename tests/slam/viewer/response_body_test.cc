#include "slam/viewer/response_body.h"

#include <array>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// The whole body, read in pieces of 7 bytes.
std::string ReadAll(Response* response) {
  std::string bytes;
  std::array<char, 7> piece{};
  while (response->body->left() > 0) {
    const std::optional<size_t> count = response->body->Read(piece);
    if (!count) return "cut off";
    bytes.append(piece.data(), *count);
  }
  return bytes;
}

class ResponseTest : public testing::Test {
 protected:
  ResponseTest() {
    WriteText(folder_ / "digits", "0123456789");
    table_["digits"] = {"text/plain", folder_ / "digits", {}};
    table_["made"] = {"text/x", {}, [] { return std::string("made on demand"); }};
    table_["bad"] = {"text/x", {}, []() -> std::string { throw UserError("view 7: is damaged"); }};
    table_["gone"] = {"text/plain", folder_ / "gone", {}};
  }

  const TempFolder folder_;
  ResourceTable table_;
};

TEST_F(ResponseTest, HasBytesMadeOnDemandOrOfAFile) {
  Response made = MakeResponse(table_, {.path = "made"});
  EXPECT_EQ(made.status, 200);
  EXPECT_EQ(made.type, "text/x");
  EXPECT_EQ(ReadAll(&made), "made on demand");
  Response file = MakeResponse(table_, {.path = "digits"});
  EXPECT_EQ(file.status, 200);
  EXPECT_EQ(ReadAll(&file), "0123456789");
}

TEST_F(ResponseTest, HasARangeOfAFile) {
  Response part = MakeResponse(table_, {.path = "digits", .range = "bytes=2-8"});
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.content_range, "bytes 2-8/10");
  EXPECT_EQ(ReadAll(&part), "2345678");
  Response outside = MakeResponse(table_, {.path = "digits", .range = "bytes=10-"});
  EXPECT_EQ(outside.status, 416);
  EXPECT_EQ(outside.content_range, "bytes */10");
}

TEST_F(ResponseTest, KnowsNoPathThatIsNotInTheTable) {
  constexpr std::string_view kWithNul("digits\0x", 8);
  for (const std::string_view path :
       {std::string_view("Digits"), std::string_view("digits/"), std::string_view("/digits"),
        std::string_view("./digits"), std::string_view("../digits"),
        std::string_view("made/../digits"), kWithNul, kWithNul.substr(0, 7),
        std::string_view("*")}) {
    EXPECT_EQ(MakeResponse(table_, {.path = path}).status, 404) << path;
  }
}

TEST_F(ResponseTest, HasWhatHasChangedSinceARevision) {
  table_["since"].make_since = [](std::uint64_t since) { return std::to_string(since + 1); };
  Response response = MakeResponse(table_, {.path = "since", .query = "since=41"});
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(ReadAll(&response), "42");
  response = MakeResponse(table_, {.path = "since"});
  EXPECT_EQ(ReadAll(&response), "1");
  EXPECT_EQ(MakeResponse(table_, {.path = "since", .query = "since=-1"}).status, 400);
}

TEST_F(ResponseTest, SaysWhyAResourceFails) {
  Response bad = MakeResponse(table_, {.path = "bad"});
  EXPECT_EQ(bad.status, 500);
  EXPECT_EQ(ReadAll(&bad), "view 7: is damaged\n");
  EXPECT_EQ(MakeResponse(table_, {.path = "gone"}).status, 500);
}

TEST_F(ResponseTest, EndsWhereAFileHasBecomeShorter) {
  Response part = MakeResponse(table_, {.path = "digits"});
  std::filesystem::resize_file(folder_ / "digits", 8);
  EXPECT_EQ(ReadAll(&part), "cut off");
  Response gone = MakeResponse(table_, {.path = "digits"});
  std::filesystem::remove(folder_ / "digits");
  EXPECT_EQ(ReadAll(&gone), "01234567");  // It is open already.
}

}  // namespace
}  // namespace orb360
