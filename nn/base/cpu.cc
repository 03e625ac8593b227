#include "nn/base/cpu.h"

#if defined(__x86_64__) && defined(__linux__)
#include <cpuid.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace orb360::nn {
namespace {

#if defined(__x86_64__) && defined(__linux__)

bool IsSet(unsigned word, int bit) { return (word >> bit & 1) != 0; }

// Returns which parts of a thread's registers the operating system saves.
std::uint64_t SavedState() {
  unsigned low = 0, high = 0;
  asm("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return std::uint64_t{high} << 32 | low;
}

// Tiles are 8 KiB more to save for every thread, so Linux requires a request (since version 5.16).
// The answer is valid for the whole process.
bool AskForTiles() {
  constexpr int kRequestPermission = 0x1023;  // ARCH_REQ_XCOMP_PERM of asm/prctl.h
  constexpr int kTileData = 18;               // bit of the saved state
  return syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
}

BFloat16Unit FindBFloat16Unit() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  constexpr int kOsSavesState = 27;  // of leaf 1, ecx
  if (__get_cpuid(1, &a, &b, &c, &d) == 0 || !IsSet(c, kOsSavesState)) return BFloat16Unit::kNone;
  constexpr std::uint64_t kVectors = 0xe6;   // SSE, AVX and AVX-512
  constexpr std::uint64_t kTiles = 0x60000;  // configuration and data
  const std::uint64_t saved = SavedState();
  if ((saved & kVectors) != kVectors) return BFloat16Unit::kNone;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return BFloat16Unit::kNone;
  const bool has_avx512 =
      IsSet(b, 16) && IsSet(b, 17) && IsSet(b, 30) && IsSet(b, 31);  // F DQ BW VL
  const bool has_amx = IsSet(d, 22) && IsSet(d, 24);                 // BF16, TILE
  if (__get_cpuid_count(7, 1, &a, &b, &c, &d) == 0) return BFloat16Unit::kNone;
  const bool has_avx512_bf16 = IsSet(a, 5);
  if (!has_avx512 || !has_avx512_bf16) return BFloat16Unit::kNone;
  const bool saves_tiles = (saved & kTiles) == kTiles;
  return has_amx && saves_tiles && AskForTiles() ? BFloat16Unit::kAmx : BFloat16Unit::kAvx512;
}

#else

BFloat16Unit FindBFloat16Unit() { return BFloat16Unit::kNone; }

#endif

}  // namespace

BFloat16Unit BestBFloat16Unit() {
  static const BFloat16Unit unit = FindBFloat16Unit();
  return unit;
}

}  // namespace orb360::nn
