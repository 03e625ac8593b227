#include "slam/pipeline/initial_map.h"

#include <optional>

#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/panoramic_triangulation.h"

namespace orb360 {

InitialMap MakeInitialMap(const PendingFrame& first, const PendingFrame& second,
                          const TwoViewMap& views, const MapperOptions& options) {
  constexpr int kIterations = 10;
  InitialMap result{.map = {}, .first = first, .second = second};
  Map& map = result.map;
  map.AddKeyframe(first.index, first.timestamp, Rigid3(), first.features);
  map.AddKeyframe(second.index, second.timestamp, views.world_from_camera2, second.features);
  map.keyframe(InitialMap::kFirst).image = first.image;
  map.keyframe(InitialMap::kSecond).image = second.image;
  for (const TwoViewMap::Point& point : views.points) {
    const LandmarkId landmark =
        map.AddLandmark(point.position, second.features->colors[point.feature2]);
    map.AddObservation(landmark, InitialMap::kFirst, point.feature1);
    map.AddObservation(landmark, InitialMap::kSecond, point.feature2);
    map.UpdateAppearance(landmark);
  }
  TriangulateNewLandmarks(InitialMap::kSecond, options.triangulation, &map);
  AdjustGlobally(kIterations, std::nullopt, 0.0, &map, options.bundle.optimizer);
  return result;
}

}  // namespace orb360
