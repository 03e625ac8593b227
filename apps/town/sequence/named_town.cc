#include "apps/town/sequence/named_town.h"

#include <array>
#include <optional>

#include "apps/town/sequence/seed.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Lengths, light and images as in the paper: 2048 x 1024 from six faces of 768 x 768.
struct Named {
  std::string_view name;
  uint64_t number;
  std::string_view light;
  double traffic;
  int frames;
  int columns;
  int rows;
  double spacing;
  int tour_blocks;
  int width;
  int cube_size;
};
/// The tours are a little shorter than the sequences, so that each path closes its loop.
constexpr std::array<Named, 6> kTowns = {
    {{"Town1", 1, "noon", 0.3, 1000, 4, 4, 37, 2, 2048, 768},
     {"Town2", 2, "sunset", 0.5, 2000, 4, 3, 54, 3, 2048, 768},
     {"Town3", 3, "morning", 0.2, 2850, 4, 4, 56, 4, 2048, 768},
     {"Town4", 4, "noon", 0.8, 3000, 5, 3, 50, 5, 2048, 768},
     {"Town5", 5, "sunset", 0.1, 1000, 4, 4, 39, 2, 2048, 768},
     {"Loop", 6, "noon", 0.0, 600, 3, 2, 36, 1, 1024, 0}}};

}  // namespace

TownSpec FindTown(std::string_view name) {
  TownSpec spec;
  spec.name = name;
  for (const Named& town : kTowns) {
    if (town.name != name) continue;
    spec.seed = (1ULL << 63) + town.number;
    spec.light = town.light;
    spec.traffic = town.traffic;
    spec.frames = town.frames;
    spec.width = town.width;
    spec.cube_size = town.cube_size;
    spec.plan.columns = town.columns;
    spec.plan.rows = town.rows;
    spec.plan.spacing = town.spacing;
    spec.plan.tour_blocks = town.tour_blocks;
    return spec;
  }
  const std::optional<uint64_t> seed = ParseSeed(name);
  if (!seed) {
    throw UserError("unknown town '" + std::string(name) +
                    "': use Town1 ... Town5, Loop, or a seed of at most 18 digits");
  }
  spec.seed = *seed;
  return spec;
}

}  // namespace orb360::town
