// Place recognition as a map grows: keyframes of 700 landmarks, each of which stays in sight for
// five keyframes, seen again with a tenth of the bits changed.

#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "slam/features/place_recognition.h"

namespace orb360 {
namespace {

constexpr int kLandmarks = 700;
constexpr int kInSight = 5;

Descriptor SeenAgain(Descriptor bits, std::mt19937_64* random) {
  for (int f = 0; f < 26; ++f) {
    const uint64_t bit = (*random)() % 256;
    bits[bit / 64] ^= uint64_t{1} << (bit % 64);
  }
  return bits;
}

std::vector<std::vector<Descriptor>> DriveThrough(int places) {
  std::mt19937_64 random(1);
  std::vector<Descriptor> landmarks(kLandmarks);
  for (Descriptor& bits : landmarks) bits = {random(), random(), random(), random()};
  std::vector<std::vector<Descriptor>> drive(places);
  for (int p = 0; p < places; ++p) {
    for (int l = 0; l < kLandmarks; ++l) {
      if (l % kInSight == p % kInSight) landmarks[l] = {random(), random(), random(), random()};
      drive[p].push_back(SeenAgain(landmarks[l], &random));
    }
  }
  return drive;
}

void BM_PlaceQuery(benchmark::State& state) {
  const auto drive = DriveThrough(static_cast<int>(state.range(0)));
  PlaceIndex index;
  for (const std::vector<Descriptor>& place : drive) index.Add(place);
  for (auto _ : state) benchmark::DoNotOptimize(index.Score(drive[drive.size() / 2]));
}
BENCHMARK(BM_PlaceQuery)->Arg(250)->Arg(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace orb360
