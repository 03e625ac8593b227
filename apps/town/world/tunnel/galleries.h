#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/box_mapping.h"
#include "apps/town/world/landscape/trail.h"

namespace orb360::town {

struct GalleryOptions {
  float half_width = 1.4F;  ///< of the round gallery, metres
  float height = 2.6F;      ///< at its middle, metres
  float arch = 0.5F;        ///< by which it is lower at its walls, metres
  float roughness = 0.15F;  ///< standard deviation of the walls, metres
  float slope = 0.3F;       ///< standard deviation of the floor's height, metres
  int side_galleries = 4;   ///< that lead away or across
  int halls = 1;
};

/// Galleries in rock: a round one along a trail, side galleries, and halls, with a common floor.
class Galleries {
 public:
  Galleries(const Trail& trail, const GalleryOptions& options, Random random);

  /// Returns the height of the floor's middle course, metres.
  float Floor(const Vector2f& p) const;
  /// Returns the surface of the rock, seen from within.
  Surface MakeSurface() const;

 private:
  /// A straight part of a gallery.
  struct Segment {
    Vector2f from, to;
    float half_width, height;
  };
  struct Hall {
    Vector2f centre;
    float radius, height;
  };
  /// What is above a point of the plan: signed distances to the walls, negative inside, and the
  /// height of the roof for a point at that distance.
  struct Plan {
    float gallery, gallery_roof, hall, hall_roof;
  };
  Plan PlanAt(const Vector2f& p) const;
  /// Returns about the distance to the rock, negative in the hollow, before it is made rough.
  float SmoothValue(const Plan& plan, float above_floor) const;

  GalleryOptions options_;
  uint32_t seed_;
  std::vector<Segment> segments_;
  std::vector<Hall> halls_;
  float reach_ = 0;  // metres from the origin, beyond which there is rock only
};

}  // namespace orb360::town
