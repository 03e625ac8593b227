#pragma once

namespace orb360::nn {

/// What the processor can do at most, measured now, of all threads together.
struct Peaks {
  double fma = 0;        ///< 10^9 operations per second of floats, MeasureFmaPeak.
  double bfloat16 = 0;   ///< The same with products of bfloat16 (VDPBF16PS); 0 without them.
  double bytes = 0;      ///< The same with products of bytes (VPDPBUSD); 0 without them.
  double bandwidth = 0;  ///< 10^9 bytes per second, read or written, of memory.
};

/// Measures each for some milliseconds, several times, and returns the best.
Peaks MeasurePeaks(int threads);

/// Runs products of bfloat16, or of bytes, that wait for nothing on every thread for about a
/// millisecond. Returns 10^9 operations per second; 0 where the processor has no such unit. (AMX's
/// tiles are not measured.)
double MeasureBFloat16Peak(int threads);
double MeasureBytePeak(int threads);

}  // namespace orb360::nn
