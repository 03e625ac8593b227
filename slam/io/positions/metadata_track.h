#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>

namespace orb360 {

/// One sample of a track that holds neither images nor sound.
struct MetadataSample {
  double start = 0;       ///< Seconds since the first frame of the video.
  double duration = 0;    ///< Seconds; 0 where the container states none.
  std::string_view data;  ///< Valid during the call only.
};

/// What a container tells of its metadata.
struct MetadataSummary {
  int num_samples = 0;  ///< Samples of tracks with the wanted tag.
  /// When the video was made by the camera's clock, seconds since 1970: often local time, and of
  /// some cameras the end of the recording.
  std::optional<double> creation_time;
};

/// Calls `take` with each sample of the tracks with the four-character tag, such as "gpmd" or
/// "camm", of an MP4 or QuickTime file, in the order of the file. Frames are skipped, not read.
/// Throws UserError for a file that is not a video container.
MetadataSummary ReadMetadataTrack(const std::filesystem::path& path, std::string_view tag,
                                  const std::function<void(const MetadataSample&)>& take);

}  // namespace orb360
