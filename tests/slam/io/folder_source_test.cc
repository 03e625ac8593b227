#include "slam/io/folder_source.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(NaturalOrder, ComparesRunsOfDigitsAsNumbers) {
  std::vector<std::string> names = {"img10", "img9", "img09b", "a2b10", "a2b9", "img", "img1"};
  std::ranges::sort(names, NaturalLess);
  EXPECT_THAT(names,
              testing::ElementsAre("a2b9", "a2b10", "img", "img1", "img9", "img09b", "img10"));
}

TEST(NaturalOrder, IsAStrictTotalOrder) {
  const std::vector<std::string> names = {"1", "01", "001", "", "a", "a1", "a01", "2", "10", "0"};
  for (const std::string& a : names) {
    EXPECT_FALSE(NaturalLess(a, a)) << a;
    for (const std::string& b : names) {
      EXPECT_EQ(NaturalLess(a, b), a != b && !NaturalLess(b, a)) << a << " and " << b;
    }
  }
}

}  // namespace
}  // namespace orb360
