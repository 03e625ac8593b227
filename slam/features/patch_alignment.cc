#include "slam/features/patch_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace orb360 {
namespace {

constexpr int kSide = 2 * Patch::kRadius + 1;
constexpr int kCount = kSide * kSide;
constexpr double kMaxShift = 2.0;        // samples
constexpr double kMinCorrelation = 0.8;  // normalized, of the weighted gray values
// Least correlation at the initial guess. Only one in 200 patches below it is aligned successfully,
// and those below take most steps.
constexpr double kMinGuessedCorrelation = 0.4;
constexpr double kMinRoundness = 0.01;  // of the smaller to the larger eigenvalue of the structure
// Noise of gray values: the least squared difference between two images of the same surface, and
// the number of independent errors among a patch's samples, which lie half a pixel apart.
constexpr double kLeastNoise = 4.0;
constexpr double kIndependent = 15.0;
constexpr int kMaxSteps = 15;
// A step is the last one when it moves the centre, and the rim by the slope, by less than these
// numbers of samples.
constexpr double kEnough = 0.01;
constexpr double kEnoughBend = 0.05;

using Values = Eigen::Array<float, kCount, 1>;

// Samples near the centre are more likely to belong to the same surface.
Values MakeWeights() {
  Values weights;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double dx = x - Patch::kRadius;
      const double dy = y - Patch::kRadius;
      weights[y * kSide + x] =
          static_cast<float>(std::exp(-(dx * dx + dy * dy) / (Patch::kRadius * Patch::kRadius)));
    }
  }
  return weights / weights.sum();
}

const Values& Weights() {
  static const Values weights = MakeWeights();
  return weights;
}

// Returns true if the samples up to `radius` from the centre, with the pixels that are blended, lie
// in the level or its margin.
bool IsInside(const PyramidLevel& level, const PatchGrid& grid, double radius) {
  const Eigen::Vector2d reach = radius * grid.steps.cwiseAbs().rowwise().sum();
  const Eigen::Vector2d least(1.0 - PyramidLevel::kMarginX, 1.0 - PyramidLevel::kMarginY);
  const Eigen::Vector2d most(level.camera.width() - least.x(), level.camera.height() - least.y());
  // The comparison is false for NaN.
  return ((grid.center - reach).array() >= least.array()).all() &&
         ((grid.center + reach).array() <= most.array()).all();
}

// Calls take(index, gray value) for the samples up to `radius`.
template <typename Take>
void Sample(const PyramidLevel& level, const PatchGrid& grid, int radius, const Take& take) {
  const Eigen::Vector2f center = grid.center.cast<float>();
  const Eigen::Matrix2f steps = grid.steps.cast<float>();
  int index = 0;
  for (int y = -radius; y <= radius; ++y) {
    const Eigen::Vector2f middle = center + static_cast<float>(y) * steps.col(1);
    for (int x = -radius; x <= radius; ++x, ++index) {
      const Eigen::Vector2f pixel = middle + static_cast<float>(x) * steps.col(0);
      take(index, SampleBilinear(level, pixel.x(), pixel.y()));
    }
  }
}

float Mean(const Values& values) { return (Weights() * values).sum(); }

float MeanProduct(const Values& a, const Values& b) { return (Weights() * a * b).sum(); }

// A patch in the form that the steps need: its values relative to their weighted mean, and their
// derivatives with respect to the parameters, which are the centre (in samples) and the slope of
// the surface.
struct Template {
  using Columns = std::array<Values, 4>;
  Values values;
  Columns by_parameter;  // x, y, slope x, slope y
  Eigen::Matrix4d structure;

  // `moved` is the number of samples by which a slope of one moves a sample at distance one from
  // the centre.
  Template(const Patch& patch, const Eigen::Vector2f& moved) {
    const auto at = [&](int x, int y) {
      return static_cast<float>(patch.gray[y * Patch::kWidth + x]);
    };
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const int i = y * kSide + x;
        values[i] = at(x + 1, y + 1);
        by_parameter[0][i] = 0.5f * (at(x + 2, y + 1) - at(x, y + 1));
        by_parameter[1][i] = 0.5f * (at(x + 1, y + 2) - at(x + 1, y));
        const float along = moved.x() * by_parameter[0][i] + moved.y() * by_parameter[1][i];
        by_parameter[2][i] = along * static_cast<float>(x - Patch::kRadius);
        by_parameter[3][i] = along * static_cast<float>(y - Patch::kRadius);
      }
    }
    values -= Mean(values);
    // Changes that a different brightness explains say nothing about position: a stretched ramp
    // looks like one with less contrast. They are removed from the derivatives.
    const float variance = MeanProduct(values, values);
    for (Values& column : by_parameter) {
      column -= Mean(column);
      column -= MeanProduct(column, values) / variance * values;
    }
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j <= i; ++j) {
        structure(i, j) = structure(j, i) = MeanProduct(by_parameter[i], by_parameter[j]);
      }
    }
  }

  // Returns true if there is enough structure in every direction to locate the centre.
  bool IsDistinct() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(structure.topLeftCorner<2, 2>());
    return eigen.eigenvalues()[0] > kMinRoundness * eigen.eigenvalues()[1];
  }

  // Information that an image with such noise gives about the slope, independent of the centre.
  Eigen::Matrix2d SlopeInformation(double squared_noise) const {
    const Eigen::Matrix2d mixed = structure.topRightCorner<2, 2>();
    return (structure.bottomRightCorner<2, 2>() -
            mixed.transpose() * structure.topLeftCorner<2, 2>().inverse() * mixed) /
           squared_noise;
  }
};

// An image's gray values on a grid, compared with a template.
struct Comparison {
  Values error;          // after the brightness is made the template's
  double correlation;    // not a number where one of both is even
  double squared_noise;  // of the mean of all errors

  Comparison(const Template& wanted, const PyramidLevel& level, const PatchGrid& grid) {
    Values seen;
    Sample(level, grid, Patch::kRadius, [&](int index, float gray) { seen[index] = gray; });
    seen -= Mean(seen);
    const float variance = MeanProduct(seen, seen);
    const float product = MeanProduct(seen, wanted.values);
    correlation = product / std::sqrt(variance * MeanProduct(wanted.values, wanted.values));
    error = product / variance * seen - wanted.values;
    squared_noise = std::max<double>(MeanProduct(error, error), kLeastNoise) / kIndependent;
  }
};

}  // namespace

std::optional<Patch> SamplePatch(const PyramidLevel& level, const PatchGrid& grid) {
  constexpr int kReach = Patch::kRadius + 1;
  if (!IsInside(level, grid, kReach)) return std::nullopt;
  Patch patch;
  Sample(level, grid, kReach,
         [&](int i, float gray) { patch.gray[i] = static_cast<uint8_t>(gray + 0.5f); });
  return patch;
}

std::optional<AlignedPatch> AlignPatch(const Patch& patch, const PyramidLevel& level,
                                       const PatchGrid& guess, const Eigen::Vector2d& stretch,
                                       const PatchSlope& slope) {
  if (!IsInside(level, guess, Patch::kRadius + kMaxShift)) return std::nullopt;
  if (!(guess.steps.determinant() > 0)) return std::nullopt;  // seen from behind
  const Eigen::Matrix2d samples_from_pixels = guess.steps.inverse();
  const Eigen::Vector2d moved = samples_from_pixels * stretch;
  const Template wanted(patch, moved.cast<float>());
  if (!wanted.IsDistinct()) return std::nullopt;
  PatchGrid grid = guess;
  Eigen::Vector2d added_slope = Eigen::Vector2d::Zero();
  for (int i = 0; i < kMaxSteps; ++i) {
    const Comparison seen(wanted, level, grid);
    if (!std::isfinite(seen.correlation)) return std::nullopt;
    if (i == 0 && seen.correlation < kMinGuessedCorrelation) return std::nullopt;
    // A step d of the template's slope is undone in the image's steps guess.steps (I + moved a^T):
    // (I + moved a^T) (I + moved d^T)^-1 = I + moved (a - growth / (1 + moved^T d) d)^T.
    const double growth = 1 + moved.dot(added_slope);
    const Eigen::Matrix2d prior = seen.squared_noise * slope.information;
    Eigen::Matrix4d normal = wanted.structure;
    normal.bottomRightCorner<2, 2>() += growth * growth * prior;
    Eigen::Vector4d gradient;
    for (int k = 0; k < 4; ++k) gradient[k] = MeanProduct(seen.error, wanted.by_parameter[k]);
    gradient.tail<2>() += growth * prior * added_slope;
    const Eigen::Vector4d step = normal.ldlt().solve(gradient);
    grid.center -= grid.steps * step.head<2>();
    added_slope -= growth / (1 + moved.dot(step.tail<2>())) * step.tail<2>();
    grid.steps = guess.steps + stretch * added_slope.transpose();
    const double shift = (samples_from_pixels * (grid.center - guess.center)).norm();
    if (!(shift <= kMaxShift && grid.steps.determinant() > 0)) return std::nullopt;
    if (!IsInside(level, grid, Patch::kRadius)) return std::nullopt;
    const double bend = Patch::kRadius * moved.norm() * step.tail<2>().norm();  // at the rim
    if (step.head<2>().norm() >= kEnough || bend >= kEnoughBend) continue;
    if (!(seen.correlation >= kMinCorrelation)) return std::nullopt;
    return AlignedPatch{
        grid.center,
        {slope.mean + added_slope,
         slope.information + wanted.SlopeInformation(growth * growth * seen.squared_noise)}};
  }
  return std::nullopt;
}

}  // namespace orb360
