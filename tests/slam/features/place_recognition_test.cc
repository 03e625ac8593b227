#include "slam/features/place_recognition.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

using Bits = std::vector<Descriptor>;

Bits RandomPlace(std::mt19937_64* random, int count = 500) {
  Bits place(count);
  for (Descriptor& descriptor : place) {
    for (uint64_t& word : descriptor) word = (*random)();
  }
  return place;
}

// The place as another view shows it: in another order, some descriptors new, the others with
// `flips` of 256 bits changed at random.
Bits SeenAgain(Bits place, int flips, double fraction, std::mt19937_64* random) {
  for (size_t i = 0; i < place.size(); ++i) {
    if (static_cast<double>(i) >= fraction * static_cast<double>(place.size())) {
      for (uint64_t& word : place[i]) word = (*random)();
    }
    for (int f = 0; f < flips; ++f) {
      const uint64_t bit = (*random)() % 256;
      place[i][bit / 64] ^= uint64_t{1} << (bit % 64);
    }
  }
  std::shuffle(place.begin(), place.end(), *random);
  return place;
}

TEST(PlaceIndex, FindsEachOfManyPlacesByAThirdOfItsDescriptorsWith35BitsChanged) {
  std::mt19937_64 random(1);
  std::vector<Bits> places;
  PlaceIndex index;
  for (int i = 0; i < 200; ++i) {
    places.push_back(RandomPlace(&random));
    EXPECT_EQ(index.Add(places.back()), i);
  }
  EXPECT_EQ(index.size(), 200);
  for (int i = 0; i < 200; i += 7) {
    const std::vector<double> scores = index.Score(SeenAgain(places[i], 35, 0.33, &random));
    ASSERT_EQ(scores.size(), 200u);
    EXPECT_EQ(std::max_element(scores.begin(), scores.end()) - scores.begin(), i);
  }
}

TEST(PlaceIndex, ScoresWhatWasNeverSeenFarBelowARevisit) {
  std::mt19937_64 random(2);
  std::vector<Bits> places;
  PlaceIndex index;
  for (int i = 0; i < 100; ++i) {
    places.push_back(RandomPlace(&random));
    index.Add(places.back());
  }
  const std::vector<double> fresh = index.Score(RandomPlace(&random));
  const std::vector<double> again = index.Score(SeenAgain(places[40], 35, 0.33, &random));
  EXPECT_LT(20.0 * *std::max_element(fresh.begin(), fresh.end()), again[40]);
}

// A facade of one window over and over says no more than the window once.
TEST(PlaceIndex, CountsTextureThatIsEverywhereForNothing) {
  std::mt19937_64 random(3);
  const Bits common = RandomPlace(&random, 400);
  PlaceIndex index;
  std::vector<Bits> own;
  for (int i = 0; i < 20; ++i) {
    own.push_back(RandomPlace(&random, 20));
    Bits place = common;
    place.insert(place.end(), own.back().begin(), own.back().end());
    index.Add(place);
  }
  Bits query = common;
  query.insert(query.end(), own[13].begin(), own[13].end());
  const std::vector<double> scores = index.Score(query);
  for (int i = 0; i < 20; ++i) {
    if (i == 13) continue;
    EXPECT_LT(scores[i], 1e-12);
  }
  EXPECT_GT(scores[13], 0.1);
}

TEST(PlaceIndex, KnowsNothingAtFirstAndBearsEmptyImages) {
  PlaceIndex index;
  EXPECT_TRUE(index.Score(Bits(3)).empty());
  index.Add({});
  EXPECT_EQ(index.Score({}), std::vector<double>{0.0});
  EXPECT_EQ(index.Score(Bits(3)), std::vector<double>{0.0});
}

}  // namespace
}  // namespace orb360
