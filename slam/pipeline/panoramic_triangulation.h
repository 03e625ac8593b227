#pragma once

#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/triangulation_options.h>

namespace orb360 {

/// The paper's panoramic triangulation module (III-A): matches the features of a keyframe that
/// have no landmark yet with those of its neighbours under the epipolar constraint (Eq. 5-7), away
/// from the epipoles, triangulates the bearings (Eq. 8-9), and keeps points with positive ranges,
/// enough parallax and small angular reprojection errors (Eq. 10). Returns the new landmarks.
std::vector<LandmarkId> TriangulateNewLandmarks(KeyframeId keyframe,
                                                const TriangulationOptions& options, Map* map);

}  // namespace orb360
