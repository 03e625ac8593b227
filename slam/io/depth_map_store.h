#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "slam/io/temporary_folder.h"
#include <orb360/slam/depth/dense_depth.h>

namespace orb360 {

/// Depth maps of frames, stored on disk. One of 1024 x 512 pixels takes
/// about 0.5 MB of disk and no memory. Frames are named by their index in the sequence, so
/// those of several maps can use one store.
///
/// Ranges are restored with an error of at most 0.05 % (their logarithms are rounded to 2^-10, in
/// 16 bits), from e^-32 to e^31 units of length. Confidences are rounded to 1/255, but not to 0.
/// The source of each range is kept; without any it is RangeSource::kNetwork.
/// Colours are compressed as JPEG. Where the range or the confidence is not positive and finite,
/// all of them are 0.
///
/// The store has no state besides the files, so different frames may be stored and read on
/// different threads at once.
class DepthMapStore {
 public:
  /// The folder lives as long as the object. Throws UserError, as Put does, if it cannot be
  /// written.
  explicit DepthMapStore(const std::filesystem::path& folder)
      : folder_(folder), temporary_(std::in_place, folder) {}
  /// Opens a folder to which depth maps have been copied. It stays as it is.
  static DepthMapStore Open(std::filesystem::path folder) {
    return {std::move(folder), std::nullopt};
  }

  /// Stores or replaces a depth map. Contract: the images have the types of DenseDepth, one common
  /// size, and at least one pixel.
  void Put(int frame_index, const DenseDepth& depth) const;

  bool Contains(int frame_index) const;

  /// Copies a depth map to another folder. Throws UserError for a frame that is not stored or is
  /// damaged, and if the disk fails.
  void CopyTo(int frame_index, const std::filesystem::path& folder) const;

  /// Throws UserError for a frame that is not stored or is damaged.
  DenseDepth Get(int frame_index) const;

 private:
  DepthMapStore(std::filesystem::path folder, std::nullopt_t /*is_kept*/)
      : folder_(std::move(folder)) {}
  std::filesystem::path PathOf(int frame_index) const;

  const std::filesystem::path folder_;
  std::optional<TemporaryFolder> temporary_;
};

}  // namespace orb360
