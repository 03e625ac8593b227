#pragma once

#include <cstddef>
#include <vector>

#include "apps/town/image/random.h"

namespace orb360::town {

struct TourOptions {
  int columns = 3;  ///< of the lattice of junctions, numbered row by row
  int rows = 3;
  int blocks = 2;  ///< how many blocks are circled, each once; at least 1
};

/// Returns a closed walk over the junctions of a lattice that never turns back: circles around
/// blocks, all in the same sense. Each block is entered at a junction of the previous walk, so that
/// the walk returns along the common side of two blocks in the opposite direction. A walk around
/// two blocks is longer and also repeats a side in the same direction soon.
std::vector<size_t> PlanTour(const TourOptions& options, Random random);

/// Returns circles around one to four blocks of the same lattice, each over some side that `tour`
/// does not use in its direction, for traffic that crosses the tour.
std::vector<std::vector<size_t>> PlanOtherTours(const std::vector<size_t>& tour, int columns,
                                                int rows, Random random);

}  // namespace orb360::town
