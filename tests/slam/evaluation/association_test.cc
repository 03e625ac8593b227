#include "slam/evaluation/association.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Times = std::vector<double>;

TEST(AssociateByTime, PairsEqualTimes) {
  EXPECT_THAT(AssociateByTime(Times{0, 1, 2}, Times{1, 2, 3}, 0.01),
              ElementsAre(IndexPair{1, 0}, IndexPair{2, 1}));
}

TEST(AssociateByTime, TheClosestPairIsMadeFirst) {
  // 1.00 could go to 1.02, but 1.03 is nearer to that.
  EXPECT_THAT(AssociateByTime(Times{1.00, 1.03}, Times{1.02}, 0.05), ElementsAre(IndexPair{1, 0}));
}

TEST(AssociateByTime, EachTimeIsUsedOnce) {
  EXPECT_THAT(AssociateByTime(Times{1.0, 1.0, 1.0}, Times{1.0, 1.0}, 0.1),
              ElementsAre(IndexPair{0, 0}, IndexPair{1, 1}));
}

TEST(AssociateByTime, TheOrderOfTheListsDoesNotMatter) {
  EXPECT_THAT(AssociateByTime(Times{2, 0, 1}, Times{1, 0, 2}, 0.01),
              ElementsAre(IndexPair{1, 1}, IndexPair{2, 0}, IndexPair{0, 2}));
}

TEST(AssociateByTime, ALargerDifferenceIsNoPair) {
  EXPECT_THAT(AssociateByTime(Times{0, 1}, Times{0.2, 1.2}, 0.19), IsEmpty());
  EXPECT_THAT(AssociateByTime(Times{0, 1}, Times{0.2, 1.2}, 0.21),
              ElementsAre(IndexPair{0, 0}, IndexPair{1, 1}));
}

TEST(AssociateByTime, EmptyListsGiveNoPairs) {
  EXPECT_THAT(AssociateByTime(Times{}, Times{1}, 1.0), IsEmpty());
  EXPECT_THAT(AssociateByTime(Times{1}, Times{}, 1.0), IsEmpty());
}

}  // namespace
}  // namespace orb360
