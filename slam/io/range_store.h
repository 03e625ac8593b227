#pragma once

#include <filesystem>

#include "slam/depth/dense_depth.h"

namespace orb360 {

/// Dense depth of keyframes, kept on disk while a run lasts: about 0.5 MB for a keyframe of
/// 1024 x 512 pixels, and no memory. Frames are named by their index in the sequence, so keyframes
/// of several maps can share a store.
///
/// Ranges come back with an error of at most 0.05 % (their logarithms are rounded to 2^-10, in 16
/// bits), from e^-32 to e^31 units of length; confidences rounded to 1/255, but not to 0; colours
/// as JPEG gives them back. Where the range or the confidence is not positive and finite, both are
/// 0.
///
/// The files are all the state there is: different frames may be stored and read on different
/// threads at once.
class RangeStore {
 public:
  /// Makes the folder; what a killed run left in it is removed. Throws UserError, as Put does,
  /// where it cannot be written.
  explicit RangeStore(std::filesystem::path folder);
  /// Removes the folder.
  ~RangeStore();
  RangeStore(const RangeStore&) = delete;
  RangeStore& operator=(const RangeStore&) = delete;

  /// Stores or replaces. Contract: the images have the types of DenseDepth, one size, and pixels.
  void Put(int frame_index, const DenseDepth& depth) const;

  bool Contains(int frame_index) const;

  /// Throws UserError for a frame that is not there, or is damaged.
  DenseDepth Get(int frame_index) const;

 private:
  std::filesystem::path PathOf(int frame_index) const;

  const std::filesystem::path folder_;
};

}  // namespace orb360
