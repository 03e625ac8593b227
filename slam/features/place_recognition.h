#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slam/features/features.h"

namespace orb360 {

/// Recognises places by their descriptors, wherever in the picture they are: the camera's yaw,
/// pitch and roll do not matter. Learned while it is used: there is no vocabulary to train or load.
///
/// Multi-index hashing (Norouzi, Punjani, Fleet, Fast Search in Hamming Space with Multi-Index
/// Hashing, CVPR 2012): keys are cut from the bits of a descriptor, each with a table of the places
/// that have shown it. Two views of a corner differ in about 35 of 256 bits, so now and then they
/// agree in a whole key, and hardly any of a million other descriptors does. A key counts for as
/// much as it tells: the logarithm of all places over those that have shown it.
class PlaceIndex {
 public:
  PlaceIndex();

  /// Learns a place and returns its number, counted from 0.
  int Add(std::span<const Descriptor> descriptors);
  int size() const { return num_places_; }

  /// How much each place looks like one with these descriptors, by number: the mean, over the
  /// descriptors, of what the keys count that the place shares.
  std::vector<double> Score(std::span<const Descriptor> descriptors) const;

 private:
  /// A key of one table that a place has shown; those of a slot are chained, newest first.
  struct Entry {
    uint32_t key;
    int32_t place;
    int32_t next;  // into the table's entries, -1 at the end
  };
  struct Table {
    std::vector<int32_t> newest;  // by slot, into entries, -1 where empty
    std::vector<Entry> entries;
  };

  int num_places_ = 0;
  std::vector<Table> tables_;
};

}  // namespace orb360
