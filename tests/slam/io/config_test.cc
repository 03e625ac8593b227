#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/config.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ConfigTest : public testing::Test {
 protected:
  ConfigTest() {
    schema_.Add("threads", &threads_, "Threads to use", 1, 64);
    schema_.Add("features.count", &count_, "Features in a frame", 100);
    schema_.Add("features.scale", &scale_, "Ratio of two pyramid levels", 1.01, 2.0);
    schema_.Add("features.mask.auto", &mask_, "Find what moves with the camera");
    schema_.Add("features.mask.file", &file_, "Image, black where features are not wanted");
    schema_.Add("mapping.min_parallax", &parallax_, "Least angle between rays, degrees", 0.0);
  }

  void Load(const std::string& yaml) {
    WriteText(folder_ / "orb360.yaml", yaml);
    LoadConfig(folder_ / "orb360.yaml", schema_);
  }

  /// The message, without the file's name and the colon after it.
  std::string ErrorOf(const std::string& yaml) {
    const std::string message = MessageOf<UserError>([&] { Load(yaml); });
    const std::string file = (folder_ / "orb360.yaml").string() + ":";
    EXPECT_TRUE(message.starts_with(file)) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(file.size());
  }

  TempFolder folder_;
  OptionSchema schema_;
  int threads_ = 2;
  int count_ = 2000;
  double scale_ = 1.2;
  bool mask_ = true;
  std::string file_;
  double parallax_ = 0.5;
};

TEST_F(ConfigTest, SetsWhatTheFileNamesAndLeavesTheRest) {
  Load("features:\n  count: 1500\n  mask:\n    auto: off\n    file: my mask.png\nthreads: 4\n");
  EXPECT_EQ(count_, 1500);
  EXPECT_FALSE(mask_);
  EXPECT_EQ(file_, "my mask.png");
  EXPECT_EQ(threads_, 4);
  EXPECT_EQ(scale_, 1.2);
  EXPECT_EQ(parallax_, 0.5);
}

TEST_F(ConfigTest, DottedKeysMayBeWrittenInOneWord) {
  Load("features.count: 700\nfeatures:\n  mask.auto: false\n");
  EXPECT_EQ(count_, 700);
  EXPECT_FALSE(mask_);
}

TEST_F(ConfigTest, EmptyFilesAndSectionsChangeNothing) {
  for (const char* yaml : {"", "# only a comment\n", "features:\n", "features:\n  count:\n"}) {
    Load(yaml);
    EXPECT_EQ(count_, 2000);
  }
}

TEST_F(ConfigTest, WholeNumbersAndExponentsAreNumbers) {
  Load("features:\n  scale: 2\nmapping:\n  min_parallax: 1.5e-3\n");
  EXPECT_EQ(scale_, 2.0);
  EXPECT_EQ(parallax_, 1.5e-3);
}

TEST_F(ConfigTest, AnUnknownKeyIsNamedWithItsLineAndTheNearestKnownOne) {
  EXPECT_EQ(ErrorOf("threads: 1\nfeatures:\n  cuont: 1500\n"),
            "3: unknown key features.cuont; did you mean features.count?");
  EXPECT_EQ(ErrorOf("min_parallax: 1\n"),
            "1: unknown key min_parallax; did you mean mapping.min_parallax?");
  EXPECT_EQ(ErrorOf("\n\nloop_closing: yes\n"),
            "3: unknown key loop_closing; `orb360 config` lists all keys");
  EXPECT_EQ(ErrorOf("feature:\n  count: 1\n"),
            "2: unknown key feature.count; did you mean features.count?");
  EXPECT_EQ(ErrorOf("mapping:\n  min_likeness: 1\n"),  // as far from min_parallax as from any word
            "2: unknown key mapping.min_likeness; `orb360 config` lists all keys");
}

TEST_F(ConfigTest, AWrongTypeIsNamedWithItsLine) {
  EXPECT_EQ(ErrorOf("features:\n  count: many\n"),
            "2: features.count must be a whole number, not `many`");
  EXPECT_EQ(ErrorOf("features:\n  count: 10.5\n"),
            "2: features.count must be a whole number, not `10.5`");
  EXPECT_EQ(ErrorOf("threads: 99999999999\n"),
            "1: threads must be a whole number, not `99999999999`");
  EXPECT_EQ(ErrorOf("features:\n  scale: 1,2\n"), "2: features.scale must be a number, not `1,2`");
  EXPECT_EQ(ErrorOf("features:\n  scale: .nan\n"),
            "2: features.scale must be a number, not `.nan`");
  EXPECT_EQ(ErrorOf("features:\n  mask:\n    auto: 2\n"),
            "3: features.mask.auto must be true or false, not `2`");
  EXPECT_EQ(ErrorOf("threads: [1, 2]\n"), "1: threads must be a single value, not a list");
  EXPECT_THAT(ErrorOf("threads:\n  count: 2\n"), HasSubstr("2: unknown key threads.count"));
}

TEST_F(ConfigTest, AValueOutOfRangeIsNamedWithTheRange) {
  EXPECT_EQ(ErrorOf("threads: 65\n"), "1: threads must be 1 to 64, not `65`");
  EXPECT_EQ(ErrorOf("features:\n  count: 99\n"),
            "2: features.count must be at least 100, not `99`");
  EXPECT_EQ(ErrorOf("features:\n  scale: 1\n"), "2: features.scale must be 1.01 to 2, not `1`");
}

TEST_F(ConfigTest, AKeySetTwiceIsNamedWithBothLines) {
  EXPECT_EQ(ErrorOf("threads: 1\nfeatures:\n  count: 500\nthreads: 2\n"),
            "4: threads is set a second time, first in line 1");
}

TEST_F(ConfigTest, BrokenYamlIsNamedWithItsLine) {
  EXPECT_THAT(ErrorOf("threads: 1\nfeatures: {count: 1\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(ErrorOf("threads: 1\n\tfeatures: 2\n"), testing::StartsWith("2: not valid YAML"));
  EXPECT_THAT(ErrorOf("just words\n"), HasSubstr("must consist of"));
}

TEST_F(ConfigTest, AMissingFileOrAFolderIsNamed) {
  EXPECT_THAT(MessageOf<UserError>([&] { LoadConfig(folder_ / "absent.yaml", schema_); }),
              AllOf(HasSubstr("absent.yaml"), HasSubstr("cannot be opened")));
  EXPECT_THAT(MessageOf<UserError>([&] { LoadConfig(folder_.path(), schema_); }),
              HasSubstr(folder_.path().string()));
}

TEST_F(ConfigTest, AnErrorLeavesEveryVariableAsItWas) {
  ErrorOf("threads: 5\nfeatures:\n  count: 5000\n  scale: 17\n");
  EXPECT_EQ(threads_, 2);
  EXPECT_EQ(count_, 2000);
}

TEST_F(ConfigTest, TheDocumentExplainsEveryOption) {
  EXPECT_EQ(DocumentConfig(schema_),
            "# Threads to use (1 to 64)\n"
            "threads: 2\n"
            "\n"
            "features:\n"
            "  # Features in a frame (at least 100)\n"
            "  count: 2000\n"
            "  # Ratio of two pyramid levels (1.01 to 2)\n"
            "  scale: 1.2\n"
            "\n"
            "  mask:\n"
            "    # Find what moves with the camera\n"
            "    auto: true\n"
            "    # Image, black where features are not wanted\n"
            "    file: \"\"\n"
            "\n"
            "mapping:\n"
            "  # Least angle between rays, degrees (at least 0)\n"
            "  min_parallax: 0.5\n");
}

TEST_F(ConfigTest, TheDocumentReadsBackToTheSameValues) {
  scale_ = 1.0 + 1.0 / 3.0;
  parallax_ = 1e-300;
  file_ = "a \"quoted\": # name\\ with\nnewline, ö and 'single'";
  mask_ = false;
  const std::string document = DocumentConfig(schema_);
  scale_ = 1.5;
  parallax_ = 3.0;
  file_ = "other";
  mask_ = true;
  Load(document);
  EXPECT_EQ(scale_, 1.0 + 1.0 / 3.0);
  EXPECT_EQ(parallax_, 1e-300);
  EXPECT_EQ(file_, "a \"quoted\": # name\\ with\nnewline, ö and 'single'");
  EXPECT_FALSE(mask_);
  EXPECT_EQ(DocumentConfig(schema_), document);
}

enum class Color { kRed, kGreen, kBlue };
constexpr const char* kColorNames[] = {"red", "green", "blue"};

TEST_F(ConfigTest, AnEnumerationIsSetByItsName) {
  Color color = Color::kGreen;
  schema_.Add("color", &color, "Color of the line", kColorNames);
  EXPECT_THAT(DocumentConfig(schema_), HasSubstr("# Color of the line (red, green or blue)\n"
                                                 "color: green\n"));
  Load("color: blue\n");
  EXPECT_EQ(color, Color::kBlue);
  EXPECT_THAT(DocumentConfig(schema_), HasSubstr("color: blue\n"));
  Load(DocumentConfig(schema_));
  EXPECT_EQ(color, Color::kBlue);
}

TEST_F(ConfigTest, AnotherWordThanAnEnumerationHasIsRefused) {
  Color color = Color::kGreen;
  schema_.Add("color", &color, "Color of the line", kColorNames);
  EXPECT_EQ(ErrorOf("threads: 3\ncolor: yellow\n"),
            "2: color must be red, green or blue, not `yellow`");
  EXPECT_EQ(color, Color::kGreen);
  EXPECT_EQ(threads_, 2);
}

}  // namespace
}  // namespace orb360
