#pragma once

#include <span>
#include <vector>

#include "slam/depth/dense_view.h"

namespace orb360 {

/// Returns those of `neighbours` whose distances from a view are nearest, by ratio, to each of
/// `distances`, on each side of the path, if the ratio is less than `max_ratio`: indices into
/// `views`, in the order of `distances`. Those at the place of the view are left out.
std::vector<size_t> ChooseViewsByDistance(std::span<const DenseView> views, size_t reference,
                                          std::span<const size_t> neighbours,
                                          std::span<const double> distances, double max_ratio);

/// The distance between two views.
double DistanceBetween(const DenseView& a, const DenseView& b);

}  // namespace orb360
