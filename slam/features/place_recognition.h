#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <orb360/slam/features/features.h>

namespace orb360 {

/// Recognises places by their descriptors. The position of a feature in the image is not used, so
/// yaw, pitch and roll of the camera do not matter. The index learns while it is used; no
/// vocabulary is trained or loaded.
///
/// Multi-index hashing (Norouzi, Punjani, Fleet, Fast Search in Hamming Space with Multi-Index
/// Hashing, CVPR 2012): keys are cut from the bits of a descriptor, and each key has a table of the
/// places that have shown it. Two views of a corner differ in about 35 of 256 bits, so they
/// sometimes agree in a whole key, while hardly any of a million other descriptors does. A key
/// contributes its information: the logarithm of the number of all places over the number of those
/// that have shown it.
class PlaceIndex {
 public:
  PlaceIndex();

  /// Adds a place and returns its number, counted from 0.
  int Add(std::span<const Descriptor> descriptors);
  int size() const { return num_places_; }

  /// Returns the similarity score of each place, by number, with one that has these descriptors:
  /// the mean, over the descriptors, of the information of the keys in common.
  std::vector<double> Score(std::span<const Descriptor> descriptors) const;

 private:
  /// A key of one table that a place has shown. The entries of a slot are chained, newest first.
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
