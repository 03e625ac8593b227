#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

enum class BalconyKind { kRailing, kSolid, kFrench };
enum class RoofKind { kFlat, kGable, kHip, kMansard };

/// Properties that all facades of a building have in common.
struct FacadeStyle {
  MaterialId wall = 0;
  Rgba wall_tint{1, 1, 1, 1};
  MaterialId ground_wall = 0;
  Rgba ground_tint{1, 1, 1, 1};
  Rgba trim_tint{1, 1, 1, 1};
  Rgba frame_tint{1, 1, 1, 1};
  Rgba shutter_tint{1, 1, 1, 1};
  int floors = 3;
  float ground_height = 3.8F;  // metres
  float floor_height = 3.0F;
  float bay = 2.8F;  // metres between window axes, roughly
  float window_width = 1.2F;
  float window_height = 1.6F;
  float sill = 0.85F;    // metres above the floor
  float reveal = 0.16F;  // metres from the wall's face to the frame
  bool surrounds = false;
  bool shutters = false;
  bool balconies = false;
  bool bands = false;
  bool quoins = false;
  bool shops = false;
  bool oriels = false;  ///< one column of windows stands out from the front
  bool ivy = false;     ///< climbs the blank sides
  BalconyKind balcony = BalconyKind::kRailing;
  RoofKind roof = RoofKind::kGable;
};

/// Draws a style for a building `width` metres wide.
FacadeStyle DrawFacadeStyle(Random& random, const Materials& materials, float width);

/// Returns the height of the eaves above the ground, metres.
inline float EavesHeight(const FacadeStyle& style) {
  return style.ground_height + style.floor_height * static_cast<float>(style.floors - 1);
}

/// Adds the wall towards the street, from `drop` below the panel's origin up to the eaves, with
/// door or shops and the ornaments.
void AddFront(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
              Random& random);

/// Adds a wall towards a neighbour, with windows if there is room for them; otherwise it is blank
/// except for climbing plants and paintings.
void AddSide(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
             bool has_windows, Random& random);

/// Adds the back of a building, which is visible only through gaps: images of windows on a flat
/// wall.
void AddBack(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
             Random& random);

}  // namespace orb360::town
