#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

enum class VehicleKind { kHatchback, kSaloon, kSuv, kVan, kEstate };
inline constexpr int kVehicleKinds = 5;

/// Returns the overall length, metres.
float VehicleLength(VehicleKind kind);
/// Returns the overall width without the mirrors, metres.
float VehicleWidth(VehicleKind kind);

/// Makes a car on its wheels: x forward, y left, z up from the road, the origin below its middle.
/// Its body takes the tint of the instance.
Mesh MakeVehicle(VehicleKind kind, const Materials& materials);

/// Draws a kind of vehicle with its frequency in streets.
VehicleKind DrawVehicleKind(Random& random);

/// Draws the colour of a car; most are greys.
Rgba DrawPaint(Random& random);

}  // namespace orb360::town
