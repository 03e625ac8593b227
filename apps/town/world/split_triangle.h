#pragma once

#include <array>
#include <cstdint>

namespace orb360::town {

using Corners = std::array<uint32_t, 3>;

/// Splits a triangle at the middles of those of its edges that `is_long(a, b)` names, and calls
/// `add(corners)` for each of the two to four parts, which have the triangle's orientation. Where
/// two triangles share an edge, both are split at the vertex that `middle(a, b)` returns. Returns
/// false, and adds nothing, if no edge is long.
template <typename IsLong, typename Middle, typename Add>
bool SplitTriangle(Corners corners, IsLong&& is_long, Middle&& middle, Add&& add) {
  auto& [a, b, c] = corners;
  const int count = is_long(a, b) + is_long(b, c) + is_long(c, a);
  if (count == 0) return false;
  // Turn the corners so that the first edge is long and, of two long ones, the second as well.
  while (!is_long(a, b) || (count == 2 && !is_long(b, c))) {
    const uint32_t first = a;
    a = b;
    b = c;
    c = first;
  }
  const uint32_t ab = middle(a, b);
  if (count == 1) {
    add(Corners{a, ab, c});
    add(Corners{ab, b, c});
    return true;
  }
  const uint32_t bc = middle(b, c);
  add(Corners{ab, b, bc});
  if (count == 2) {
    add(Corners{a, ab, bc});
    add(Corners{a, bc, c});
    return true;
  }
  const uint32_t ca = middle(c, a);
  add(Corners{a, ab, ca});
  add(Corners{bc, c, ca});
  add(Corners{ab, bc, ca});
  return true;
}

}  // namespace orb360::town
