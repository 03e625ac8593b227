#pragma once

#include <span>

#include "slam/io/sparse_model.h"
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// Returns what other programs need of a run, in the frames of written files. `maps` are those of
/// the reconstruction (Reconstruction::maps), and `camera` that of the frames.
///
/// Frames and keyframes of the run that made a loaded map are left out, because their images belong
/// to another input; so are landmarks that only those keyframes observe. The pixel of an
/// observation is where the landmark's patch was aligned, as bundle adjustment uses it, and else
/// that of the feature.
SparseModel MakeSparseModel(const Reconstruction& reconstruction, std::span<const Map> maps,
                            const EquirectangularCamera& camera, const Rigid3& file_world_from_map);

}  // namespace orb360
