#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

enum class VehicleKind { kHatchback, kSaloon, kSuv, kVan, kEstate };
inline constexpr int kVehicleKinds = 5;

/// Length over all in metres.
float VehicleLength(VehicleKind kind);
/// Width over all but the mirrors in metres.
float VehicleWidth(VehicleKind kind);

/// A car on its wheels: x forward, y left, z up from the road, the origin below its middle. Its
/// body takes the tint of the instance.
Mesh MakeVehicle(VehicleKind kind, const Materials& materials);

/// A kind of vehicle, as often as they are seen in streets.
VehicleKind DrawVehicleKind(Random& random);

/// A car colour, most of them greys.
Rgba DrawPaint(Random& random);

}  // namespace orb360::town
