#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <opencv2/core.hpp>

#include "slam/io/export/export_scene.h"
#include <orb360/slam/io/sequence.h>

namespace orb360 {

/// Called after each frame with the number of frames done and that of all. Returns false to stop.
using ExportProgress = std::function<bool(int done, int count)>;

/// Returns the frame of an index, the next or a later one that `sequence` gives; `input` names the
/// sequence in errors. Throws UserError where it has none.
Frame ReadFrame(Sequence* sequence, int index, const std::string& input);

/// Writes the images of all frames and views below `folder`/images. `sequence` gives the frames of
/// the scene, and perhaps others, in their order; `input` names it in errors. One frame is in
/// memory at a time. Throws UserError where a frame is missing or the disk fails. Returns the
/// number of frames that were written, which is smaller where `progress` stopped.
int WriteViewImages(const ExportScene& scene, const std::string& input, Sequence* sequence,
                    const std::filesystem::path& folder, const ExportProgress& progress);

/// Writes a mask for each image below `folder`/masks (MaskName): 8-bit PNG, 0 where the image is
/// not to be used, else 255. `mask` is a panorama of any size. Throws UserError.
void WriteViewMasks(const ExportScene& scene, const cv::Mat& mask,
                    const std::filesystem::path& folder);

}  // namespace orb360
