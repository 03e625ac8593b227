#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>
#include <orb360/nn/base/option_schema.h>

namespace orb360 {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

enum class Color { kRed, kGreen, kBlue };
constexpr const char* kColorNames[] = {"red", "green", "blue"};

struct BrushOptions {
  int width = 3;
  int layers = 1;
  double opacity = 1.0;
  double angle = 0.0;
  bool is_round = true;
  std::string name = "pen";
  Color color = Color::kGreen;
};

void RegisterOptions(OptionSchema* schema, BrushOptions* options) {
  schema->Add("brush.width", &options->width, "width of a stroke, pixels", 1, 64);
  schema->Add("brush.layers", &options->layers, "strokes above each other", 1);
  schema->Add("brush.opacity", &options->opacity, "fraction of the light that is held back", 0.25,
              1.0);
  schema->Add("brush.angle", &options->angle, "direction of a stroke, radians");
  schema->Add("brush.is_round", &options->is_round, "round ends");
  schema->Add("brush.name", &options->name, "name in the list of brushes");
  schema->Add("brush.color", &options->color, "colour of a stroke", kColorNames);
}

/// The message of the ContractError that checking `options` throws; empty if it throws nothing.
std::string ErrorOf(const BrushOptions& options) {
  try {
    ValidateOptions(options);
  } catch (const ContractError& error) {
    return error.what();
  }
  return {};
}

TEST(OptionSchema, OptionsKeepTheOrderOfRegistration) {
  BrushOptions options;
  OptionSchema schema;
  RegisterOptions(&schema, &options);
  std::vector<std::string> keys;
  for (const OptionSchema::Option& option : schema.options()) keys.push_back(option.key);
  EXPECT_THAT(keys, ElementsAre("brush.width", "brush.layers", "brush.opacity", "brush.angle",
                                "brush.is_round", "brush.name", "brush.color"));
}

TEST(OptionSchema, AnOptionIsFoundByItsWholeKey) {
  int first = 1;
  int second = 2;
  OptionSchema schema;
  schema.Add("a.first", &first, "");
  schema.Add("a.second", &second, "");
  ASSERT_NE(schema.Find("a.second"), nullptr);
  EXPECT_EQ(std::get<int*>(schema.Find("a.second")->variable), &second);
  EXPECT_EQ(schema.Find("second"), nullptr);
  EXPECT_EQ(schema.Find("a"), nullptr);
}

TEST(OptionSchema, AChoiceReadsAndWritesItsVariable) {
  Color color = Color::kBlue;
  OptionSchema schema;
  schema.Add("color", &color, "", kColorNames);
  const auto& choice = std::get<OptionSchema::Choice>(schema.Find("color")->variable);
  EXPECT_EQ(choice.names[choice.get()], "blue");
  choice.set(0);
  EXPECT_EQ(color, Color::kRed);
}

TEST(OptionSchema, KeysThatCannotStandInOneFileBreakTheContract) {
  int value = 5;
  OptionSchema schema;
  schema.Add("threads", &value, "");
  schema.Add("features.count", &value, "");
  EXPECT_THROW(schema.Add("threads", &value, ""), ContractError);
  EXPECT_THROW(schema.Add("features", &value, ""), ContractError);
  EXPECT_THROW(schema.Add("threads.count", &value, ""), ContractError);
  EXPECT_NO_THROW(schema.Add("threads_used", &value, ""));
}

TEST(OptionSchema, RangesReadAsText) {
  BrushOptions options;
  OptionSchema schema;
  RegisterOptions(&schema, &options);
  double cold = -300.0;
  schema.Add("cold", &cold, "", -OptionSchema::kInfinity, -273.15);
  int many = 1000000;
  schema.Add("many", &many, "", 1000000, 2000000000);
  const auto range = [&](const char* key) { return RangeText(*schema.Find(key)); };
  EXPECT_EQ(range("brush.width"), "1 to 64");
  EXPECT_EQ(range("brush.layers"), "at least 1");
  EXPECT_EQ(range("brush.opacity"), "0.25 to 1");
  EXPECT_EQ(range("many"), "1000000 to 2000000000") << "integers have no exponent";
  EXPECT_EQ(range("cold"), "at most -273.15");
  EXPECT_EQ(range("brush.color"), "red, green or blue");
  for (const char* key : {"brush.angle", "brush.is_round", "brush.name"}) {
    EXPECT_EQ(range(key), "") << key;
  }
}

TEST(ValidateOptions, AcceptsTheEndsOfEveryRange) {
  EXPECT_EQ(ErrorOf({}), "");
  EXPECT_EQ(ErrorOf({.width = 1, .layers = 1, .opacity = 0.25, .color = Color::kRed}), "");
  EXPECT_EQ(ErrorOf({.width = 64,
                     .layers = std::numeric_limits<int>::max(),
                     .opacity = 1.0,
                     .angle = -1e300,
                     .color = Color::kBlue}),
            "");
}

TEST(ValidateOptions, NamesKeyValueAndRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ErrorOf({.width = 65}), "brush.width must be 1 to 64, not 65");
  EXPECT_EQ(ErrorOf({.width = 0}), "brush.width must be 1 to 64, not 0");
  EXPECT_EQ(ErrorOf({.layers = -7}), "brush.layers must be at least 1, not -7");
  EXPECT_EQ(ErrorOf({.opacity = 1.5}), "brush.opacity must be 0.25 to 1, not 1.5");
  EXPECT_EQ(ErrorOf({.opacity = kNan}), "brush.opacity must be 0.25 to 1, not nan");
  EXPECT_EQ(ErrorOf({.angle = OptionSchema::kInfinity}),
            "brush.angle must be a finite number, not inf");
  EXPECT_THAT(ErrorOf({.color = static_cast<Color>(3)}),
              HasSubstr("brush.color must be red, green or blue"));
}

}  // namespace
}  // namespace orb360
