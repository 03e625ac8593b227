#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

namespace orb360::town {

/// A well-mixed 64-bit hash (the finalizer of SplitMix64).
inline uint64_t Hash(uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Random numbers that are the same on every platform, unlike those of the standard library's
/// distributions.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(Hash(seed)) {}

  uint64_t Next() { return Hash(state_++); }
  /// Uniform in [0, 1).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Uniform in {0, ..., count - 1}.
  int Int(int count) { return static_cast<int>(Uniform() * count); }
  bool Chance(double probability) { return Uniform() < probability; }
  double Gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * Uniform());
  }
  template <typename T>
  const T& Pick(std::span<const T> values) {
    return values[static_cast<size_t>(Int(static_cast<int>(values.size())))];
  }
  /// Returns an independent generator for one part of the work, so that a change in the number of
  /// draws of another part does not affect this one.
  Random Fork(uint64_t part) const {
    return Random(Hash(state_) ^ Hash(part * 0x632be59bd9b4e019ULL));
  }

 private:
  uint64_t state_;
};

}  // namespace orb360::town
