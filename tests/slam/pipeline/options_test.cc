#include <cmath>
#include <fstream>
#include <iomanip>
#include <regex>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "nn/base/number_text.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/io/config.h>
#include <orb360/slam/pipeline/options.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string ErrorOfSystem(const Options& options) {
  return MessageOf<ContractError>(
      [&] { System(EquirectangularCamera(640, 320), options, cv::Mat()); });
}

TEST(Options, ASystemRefusesAnOptionOutOfRangeByKeyValueAndRange) {
  Options options;
  options.orb.num_features = 99;
  EXPECT_EQ(ErrorOfSystem(options), "features.count must be 100 to 20000, not 99");
  options = {};
  options.mapper.bundle.height_sigma = 2.0;
  EXPECT_EQ(ErrorOfSystem(options), "scale.height_sigma must be 0.001 to 1, not 2");
  options = {};
  options.loop.max_drift = std::nan("");
  EXPECT_EQ(ErrorOfSystem(options), "loop.max_drift must be 0 to 10, not nan");
  options = {};
  options.mapper.bundle.optimizer = static_cast<Optimizer>(2);
  EXPECT_THAT(ErrorOfSystem(options), StartsWith("optimizer must be schur or ceres"));
}

TEST(Options, EveryNumberIsCheckedAtBothEndsOfItsRange) {
  Options options;
  OptionSchema schema;
  RegisterOptions(&schema, &options);
  int num_checked = 0;
  for (const OptionSchema::Option& option : schema.options()) {
    for (const double direction : {-1.0, 1.0}) {
      const double end = direction < 0 ? option.min : option.max;
      if (int* const* number = std::get_if<int*>(&option.variable)) {
        const int value = **number;
        **number = static_cast<int>(end);
        EXPECT_NO_THROW(ValidateOptions(options)) << option.key;
        **number = static_cast<int>(end + direction);
        EXPECT_THAT(ErrorOfSystem(options), AllOf(StartsWith(option.key + " must be"),
                                                  HasSubstr("not " + ToText(**number))));
        **number = value;
      } else if (double* const* real = std::get_if<double*>(&option.variable)) {
        const double value = **real;
        **real = end;
        EXPECT_NO_THROW(ValidateOptions(options)) << option.key;
        **real = end + direction * 0.01;
        EXPECT_THAT(ErrorOfSystem(options),
                    AllOf(StartsWith(option.key + " must be"), HasSubstr("not " + ToText(**real))));
        **real = value;
      } else {
        continue;
      }
      ++num_checked;
    }
  }
  EXPECT_GT(num_checked, 2 * 60);
}

/// Each option as docs/formats/configuration.md has it: "key = default (range)".
std::vector<std::string> OptionsOfTheTable() {
  std::ifstream file(ORB360_SOURCE_DIR "/docs/formats/configuration.md");
  const std::regex row("\\| `([^`]+)` \\| ([^|]+) \\| ([^|]*) \\| [^|]+ \\|");
  std::vector<std::string> options;
  std::smatch cells;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("| `")) continue;
    EXPECT_TRUE(std::regex_match(line, cells, row)) << line;
    options.push_back(cells.str(1) + " = " + cells.str(2) + " (" + cells.str(3) + ")");
  }
  return options;
}

/// The same of the registered options. Numbers are written without an exponent, as in the table.
std::vector<std::string> RegisteredOptions() {
  const auto plain = [](double number) {
    std::ostringstream text;
    text << std::setprecision(9) << number;
    return text.str();
  };
  Options options;
  OptionSchema schema;
  RegisterOptions(&schema, &options);
  std::vector<std::string> result;
  for (const OptionSchema::Option& option : schema.options()) {
    std::string value;
    std::string range = plain(option.min) + " to " + plain(option.max);
    if (bool* const* flag = std::get_if<bool*>(&option.variable)) {
      value = **flag ? "true" : "false";
      range.clear();
    } else if (const auto* choice = std::get_if<OptionSchema::Choice>(&option.variable)) {
      value = choice->names[choice->get()];
      range = RangeText(option);
    } else if (int* const* number = std::get_if<int*>(&option.variable)) {
      value = plain(**number);
    } else {
      value = plain(*std::get<double*>(option.variable));
    }
    result.push_back(option.key);
    result.back().append(" = ").append(value).append(" (").append(range).append(")");
  }
  return result;
}

TEST(Options, TheTableOfTheDocumentsHasEveryKeyWithItsDefaultAndRangeInOrder) {
  EXPECT_THAT(RegisteredOptions(), ElementsAreArray(OptionsOfTheTable()));
}

TEST(Options, ADocumentedConfigurationReadsBackToTheDefaults) {
  Options options;
  OptionSchema schema;
  RegisterOptions(&schema, &options);
  const std::string defaults = DocumentConfig(schema);
  const TempFolder folder;
  WriteText(folder / "defaults.yaml", defaults);
  options.orb.num_features = 500;
  options.loop.enabled = false;
  options.mapper.bundle.optimizer = Optimizer::kCeres;
  LoadConfig(folder / "defaults.yaml", schema);
  EXPECT_EQ(options.orb.num_features, OrbOptions().num_features);
  EXPECT_TRUE(options.loop.enabled);
  EXPECT_EQ(options.mapper.bundle.optimizer, Optimizer::kSchur);
  EXPECT_EQ(DocumentConfig(schema), defaults);
}

}  // namespace
}  // namespace orb360
