#include "slam/io/octree/point_sorter.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

std::vector<std::pair<std::uint64_t, std::uint32_t>> Sorted(size_t count, size_t max_in_memory) {
  const TempFolder folder;
  PointSorter sorter(folder / "sort", max_in_memory);
  std::mt19937 random(3);
  for (std::uint32_t i = 0; i < count; ++i) {
    SortedPoint point;
    point.code = random() % 500;  // many equal ones
    point.index = i;
    point.position = {static_cast<float>(i), 0, 0};
    sorter.Add(point);
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  sorter.Merge([&](const SortedPoint& point) {
    EXPECT_EQ(point.position[0], static_cast<float>(point.index));
    order.emplace_back(point.code, point.index);
  });
  return order;
}

TEST(PointSorter, SortsMorePointsThanItHoldsInMemory) {
  for (const size_t max_in_memory : {1000000, 20000, 19999, 7777, 300}) {
    const auto order = Sorted(20000, max_in_memory);
    EXPECT_EQ(order.size(), 20000U);
    EXPECT_TRUE(std::ranges::is_sorted(order));
    EXPECT_EQ(std::ranges::adjacent_find(order), order.end());
  }
  EXPECT_TRUE(Sorted(0, 10).empty());
}

TEST(PointSorter, RemovesItsFolder) {
  const TempFolder folder;
  {
    PointSorter sorter(folder / "sort", 2);
    for (int i = 0; i < 5; ++i) sorter.Add({});
    EXPECT_TRUE(std::filesystem::exists(folder / "sort"));
    sorter.Merge([](const SortedPoint&) {});
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "sort"));
}

TEST(PointSorter, SaysThatAFileIsDamaged) {
  const TempFolder folder;
  PointSorter sorter(folder / "sort", 2);
  for (int i = 0; i < 5; ++i) sorter.Add({});
  std::filesystem::resize_file(folder / "sort" / "0", 10);
  EXPECT_THAT(MessageOf<UserError>([&] { sorter.Merge([](const SortedPoint&) {}); }),
              testing::HasSubstr("damaged"));
}

}  // namespace
}  // namespace orb360
