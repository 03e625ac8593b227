#include "slam/features/place_recognition.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace orb360 {
namespace {

// Five keys of 24 bits recognise as many places as ten and need half of the time and memory
// (docs/results/loops.md).
constexpr int kKeyBits = 24;
constexpr int kTables = 5;
constexpr int kSlotBits = 18;  // of a table: some entries in each, with a thousand places

using Keys = std::array<uint32_t, kTables>;

Keys KeysOf(const Descriptor& descriptor) {
  constexpr uint64_t kMask = (uint64_t{1} << kKeyBits) - 1;
  Keys keys;
  for (int t = 0; t < kTables; ++t) {
    const int word = t * kKeyBits / 64;
    const int shift = t * kKeyBits % 64;
    uint64_t bits = descriptor[word] >> shift;
    if (shift + kKeyBits > 64) bits |= descriptor[word + 1] << (64 - shift);
    keys[t] = static_cast<uint32_t>(bits & kMask);
  }
  return keys;
}

// Multiplicative hashing by the golden ratio, so that the highest bits depend on all bits of the
// key.
uint32_t SlotOf(uint32_t key) { return (key * 2654435769u) >> (32 - kSlotBits); }

}  // namespace

PlaceIndex::PlaceIndex() : tables_(kTables) {
  for (Table& table : tables_) table.newest.assign(size_t{1} << kSlotBits, -1);
}

int PlaceIndex::Add(std::span<const Descriptor> descriptors) {
  const int place = num_places_++;
  for (const Descriptor& descriptor : descriptors) {
    const Keys keys = KeysOf(descriptor);
    for (int t = 0; t < kTables; ++t) {
      Table& table = tables_[t];
      int32_t& newest = table.newest[SlotOf(keys[t])];
      // A place is listed once for a key, because repeated texture carries no further information.
      bool is_new = true;
      for (int32_t e = newest; e >= 0 && table.entries[e].place == place && is_new;
           e = table.entries[e].next) {
        is_new = table.entries[e].key != keys[t];
      }
      if (!is_new) continue;
      table.entries.push_back({keys[t], place, newest});
      newest = static_cast<int32_t>(table.entries.size()) - 1;
    }
  }
  return place;
}

std::vector<double> PlaceIndex::Score(std::span<const Descriptor> descriptors) const {
  std::vector<double> scores(num_places_, 0.0);
  std::vector<int32_t> shown;  // places with the key, newest first
  for (const Descriptor& descriptor : descriptors) {
    const Keys keys = KeysOf(descriptor);
    for (int t = 0; t < kTables; ++t) {
      const Table& table = tables_[t];
      shown.clear();
      for (int32_t e = table.newest[SlotOf(keys[t])]; e >= 0; e = table.entries[e].next) {
        if (table.entries[e].key == keys[t]) shown.push_back(table.entries[e].place);
      }
      if (shown.empty()) continue;
      const double weight =
          std::log(static_cast<double>(num_places_) / static_cast<double>(shown.size()));
      for (const int32_t place : shown) scores[place] += weight;
    }
  }
  const auto count = static_cast<double>(std::max<size_t>(1, descriptors.size()));
  for (double& score : scores) score /= count;
  return scores;
}

}  // namespace orb360
