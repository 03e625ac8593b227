#include "slam/features/patch_alignment.h"

#include <cmath>

#include <Eigen/Dense>

namespace orb360 {
namespace {

constexpr int kSide = 2 * Patch::kRadius + 1;
constexpr int kCount = kSide * kSide;
constexpr double kMaxShift = 2.0;        // samples
constexpr double kMinCorrelation = 0.8;  // normalized, of the weighted gray values
constexpr double kMinRoundness = 0.01;   // of the smaller to the larger eigenvalue of the structure
constexpr int kMaxSteps = 15;
constexpr double kEnough = 0.01;  // samples that a step moves, to be the last

using Values = Eigen::Array<float, kCount, 1>;

// What is near the centre belongs to the same surface more likely.
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

// Whether samples up to `radius` from the centre lie in the level or its margin, with the pixels
// that are blended.
bool IsInside(const PyramidLevel& level, const PatchGrid& grid, double radius) {
  const Eigen::Vector2d reach = radius * grid.steps.cwiseAbs().rowwise().sum();
  const Eigen::Vector2d least(1.0 - PyramidLevel::kMarginX, 1.0 - PyramidLevel::kMarginY);
  const Eigen::Vector2d most(level.camera.width() - least.x(), level.camera.height() - least.y());
  // Not so for what is not a number.
  return ((grid.center - reach).array() >= least.array()).all() &&
         ((grid.center + reach).array() <= most.array()).all();
}

float Blend(const PyramidLevel& level, float u, float v) {
  const float x = u + (PyramidLevel::kMarginX - 0.5f);  // of the padded image, positive
  const float y = v + (PyramidLevel::kMarginY - 0.5f);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float a = x - static_cast<float>(column);
  const float b = y - static_cast<float>(row);
  const uint8_t* upper = level.padded.ptr(row) + column;
  const uint8_t* lower = upper + level.padded.step;
  const float top = static_cast<float>(upper[0]) + a * static_cast<float>(upper[1] - upper[0]);
  const float bottom = static_cast<float>(lower[0]) + a * static_cast<float>(lower[1] - lower[0]);
  return top + b * (bottom - top);
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
      take(index, Blend(level, pixel.x(), pixel.y()));
    }
  }
}

// A patch as the steps need it: values and gradients about their weighted means.
struct Template {
  Values values;
  Values gradient_x;  // per sample
  Values gradient_y;
  double variance;
  Eigen::Matrix2d structure;

  explicit Template(const Patch& patch) {
    const auto at = [&](int x, int y) {
      return static_cast<float>(patch.gray[y * Patch::kWidth + x]);
    };
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const int i = y * kSide + x;
        values[i] = at(x + 1, y + 1);
        gradient_x[i] = 0.5f * (at(x + 2, y + 1) - at(x, y + 1));
        gradient_y[i] = 0.5f * (at(x + 1, y + 2) - at(x + 1, y));
      }
    }
    const Values& w = Weights();
    for (Values* column : {&values, &gradient_x, &gradient_y}) *column -= (w * *column).sum();
    variance = (w * values.square()).sum();
    const double mixed = (w * gradient_x * gradient_y).sum();
    structure << (w * gradient_x.square()).sum(), mixed, mixed, (w * gradient_y.square()).sum();
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

std::optional<Eigen::Vector2d> AlignPatch(const Patch& patch, const PyramidLevel& level,
                                          const PatchGrid& guess) {
  if (!IsInside(level, guess, Patch::kRadius + kMaxShift)) return std::nullopt;
  const Template wanted(patch);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(wanted.structure);
  if (!(eigen.eigenvalues()[0] > kMinRoundness * eigen.eigenvalues()[1])) return std::nullopt;
  const Eigen::Matrix2d inverse = wanted.structure.inverse();
  const Values& w = Weights();
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // samples
  for (int i = 0; i < kMaxSteps; ++i) {
    const PatchGrid grid{guess.center + guess.steps * shift, guess.steps};
    Values seen;
    Sample(level, grid, Patch::kRadius, [&](int index, float gray) { seen[index] = gray; });
    seen -= (w * seen).sum();
    const double variance = (w * seen.square()).sum();
    const double product = (w * seen * wanted.values).sum();
    if (!(variance > 0)) return std::nullopt;
    const double correlation = product / std::sqrt(variance * wanted.variance);
    const Values error = w * (static_cast<float>(product / variance) * seen - wanted.values);
    const Eigen::Vector2d step = inverse * Eigen::Vector2d((error * wanted.gradient_x).sum(),
                                                           (error * wanted.gradient_y).sum());
    shift -= step;
    if (!(shift.norm() <= kMaxShift)) return std::nullopt;
    if (step.norm() >= kEnough) continue;
    if (!(correlation >= kMinCorrelation)) return std::nullopt;
    return guess.center + guess.steps * shift;
  }
  return std::nullopt;
}

}  // namespace orb360
