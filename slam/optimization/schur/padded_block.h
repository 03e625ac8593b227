#pragma once

#include <Eigen/Core>

namespace orb360 {

/// Blocks of the normal equations belong to variables with six (SE(3)) or seven (Sim(3)) unknowns.
/// Their columns are padded with zeros to eight rows, so that vector instructions of 2, 4 or 8
/// lanes take whole columns without a remainder.
inline constexpr int kPaddedRows = 8;

using PaddedVector = Eigen::Matrix<double, kPaddedRows, 1>;
template <int kColumns>
using PaddedBlock = Eigen::Matrix<double, kPaddedRows, kColumns>;

}  // namespace orb360
