#pragma once

#include <filesystem>
#include <optional>

#include "slam/io/positions/position_track.h"

namespace orb360 {

/// Reads the positions in a file of any known kind: GPX, a video with a telemetry track (GPMF or
/// CAMM), or a folder of JPEG images with GPS in their Exif, whose times are those of its frames
/// (ListFrames; a sequence folder tells them). `frame_rate`: what the user gave in place of the
/// times of images, frames per second. Throws UserError where the file cannot be read or has fewer
/// than three positions, and for a video with a frame rate.
PositionTrack ReadPositions(const std::filesystem::path& path,
                            const std::optional<double>& frame_rate = {});

/// The same for the input of a run itself: a video, a folder of images or a sequence folder.
/// Returns nullopt where it carries no positions. Throws UserError where it cannot be read.
std::optional<PositionTrack> FindPositions(const std::filesystem::path& input,
                                           const std::optional<double>& frame_rate = {});

}  // namespace orb360
