#pragma once

#include <span>
#include <vector>

#include "slam/io/sparse_model.h"

namespace orb360 {

/// Returns for each frame the median distance of what the nearest keyframe in time observes, in the
/// unit of the map. Where keyframes observe nothing, it is the median over those that do, and 1
/// where none does.
std::vector<double> SurroundingRanges(const SparseModel& model);

/// Selects frames whose positions are about `spacing` times the range of the surroundings apart,
/// and of the candidates the sharpest. The first selected frame is the sharpest of those nearer
/// than half of that to the start. From each selected frame on, the candidates are the frames at
/// 0.5 to 1.5 times that distance, until the camera first goes beyond; where it never stops
/// between, the first frame beyond is taken. So two selected frames that follow each other are at
/// least half of the distance apart (which is the least motion), and no part of the path that is
/// longer than one and a half of it, and has frames, is left out (which is the overlap; a panorama
/// loses nothing by turning). `sharpness` has a value for each frame of the model, all of one map.
std::vector<bool> SelectSharpest(const SparseModel& model, std::span<const double> sharpness,
                                 double spacing);

}  // namespace orb360
