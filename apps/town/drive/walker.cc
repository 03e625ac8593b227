#include "apps/town/drive/walker.h"

#include <algorithm>
#include <cmath>

namespace orb360::town {

Walker::State Walker::At(const StreetPlan& plan, double time) const {
  const Street& on = plan.streets[street];
  const double length = to - from;
  // Walking there and back is one round of a circle of twice the way's length.
  State state;
  state.walked = speed * time;
  const double round = start + state.walked;
  const double turned = round - 2 * length * std::floor(round / (2 * length));
  const bool is_returning = turned > length;
  const StreetPoint p = on.At(from + (is_returning ? 2 * length - turned : turned));
  const Vector2d outward = side * Vector2d(-p.tangent.y(), p.tangent.x());
  state.position = p.position + (p.half_width + from_kerb) * outward;
  state.forward = (speed > 0) != is_returning ? p.tangent : Vector2d(-p.tangent);
  return state;
}

Walker DrawWalker(const StreetPlan& plan, size_t street, Random& random) {
  Walker walker;
  walker.street = street;
  walker.side = random.Chance(0.5) ? 1 : -1;
  walker.from_kerb = random.Uniform(1.0, std::max(1.1, plan.streets[street].pavement - 0.4));
  // The walk goes up and down as far as no roundabout is in the way.
  const Street& on = plan.streets[street];
  const auto is_open = [&](double station) {
    return station > 0 && station < on.Length() &&
           std::none_of(plan.roundabouts.begin(), plan.roundabouts.end(),
                        [&](const Roundabout& roundabout) {
                          return (on.At(station).position - roundabout.centre).norm() <
                                 roundabout.outer_radius + 4;
                        });
  };
  double place = random.Uniform(0, on.Length());
  while (!is_open(place)) place = random.Uniform(0, on.Length());
  walker.from = place;
  walker.to = place;
  while (is_open(walker.from - 1)) walker.from -= 1;
  while (is_open(walker.to + 1)) walker.to += 1;
  walker.start = place - walker.from;
  walker.speed = (random.Chance(0.5) ? 1 : -1) * random.Uniform(0.9, 1.7);
  return walker;
}

}  // namespace orb360::town
