#pragma once

namespace orb360::nn {

/// Runs fused multiply-adds that wait for nothing on every thread, with the vectors Highway uses on
/// this processor, for about a millisecond.
/// \return 10^9 floating-point operations per second, of all threads together.
double MeasureFmaPeak(int threads);

}  // namespace orb360::nn
