#include "slam/pipeline/fifo_cache.h"

#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(FifoCache, MakesAValueOnceWhileItIsAmongTheLast) {
  std::vector<std::size_t> made;
  FifoCache<int> cache(2, [&](std::size_t key) {
    made.push_back(key);
    return static_cast<int>(10 * key);
  });
  for (const std::size_t key : {1, 2, 1, 2}) EXPECT_EQ(cache.Get(key), 10 * static_cast<int>(key));
  EXPECT_THAT(made, testing::ElementsAre(1, 2));
  EXPECT_EQ(cache.Get(3), 30);  // in the place of 1, which came first
  EXPECT_EQ(cache.Get(2), 20);
  EXPECT_EQ(cache.Get(1), 10);
  EXPECT_THAT(made, testing::ElementsAre(1, 2, 3, 1));
}

TEST(FifoCache, AValueThatCannotBeMadeReplacesNone) {
  FifoCache<int> cache(1, [made = 0](std::size_t key) mutable {
    if (key == 2) throw std::runtime_error("there is none");
    return ++made;
  });
  EXPECT_EQ(cache.Get(1), 1);
  EXPECT_THROW(cache.Get(2), std::runtime_error);
  EXPECT_EQ(cache.Get(1), 1);
}

}  // namespace
}  // namespace orb360
