#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "apps/town/drive/carried_camera.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// The town to be rendered and its settings.
struct TownSpec {
  std::string name;  ///< as the user gave it
  uint64_t seed = 0;
  std::string light = "noon";
  double traffic = 0;  ///< density, 0 to 1
  int frames = 600;    ///< that show all of it, at 20 a second
  int width = 1024;    ///< of the panorama, pixels
  int cube_size = 0;   ///< of the faces that it is stitched from, pixels; 0: rendered directly
  Mount mount;
  PlanOptions plan;  ///< its seed is drawn from `seed`
};

/// Returns the evaluation towns Town1 ... Town5 and Loop (once round a block) by name, or the
/// training town of a seed (an integer of at most 18 digits). The seeds of evaluation towns lie
/// above 2^63, so they cannot be those of training towns. Throws UserError for any other name.
TownSpec FindTown(std::string_view name);

}  // namespace orb360::town
