#include "nn/base/cpu.h"

#if defined(__x86_64__) && defined(__linux__)
#include <cpuid.h>
#include <sys/syscall.h>
#include <unistd.h>
#elif defined(__aarch64__) && defined(__linux__)
#include <sys/auxv.h>
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

struct Features {
  bool avx512 = false;  // F, DQ, BW and VL, and the operating system saves its registers
  bool vnni = false;
  bool bfloat16 = false;
  bool amx = false;  // and the operating system saves its tiles
};

Features FindFeatures() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  constexpr int kOsSavesState = 27;  // of leaf 1, ecx
  if (__get_cpuid(1, &a, &b, &c, &d) == 0 || !IsSet(c, kOsSavesState)) return {};
  constexpr std::uint64_t kVectors = 0xe6;   // SSE, AVX and AVX-512
  constexpr std::uint64_t kTiles = 0x60000;  // configuration and data
  const std::uint64_t saved = SavedState();
  if ((saved & kVectors) != kVectors) return {};
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return {};
  Features features;
  features.avx512 = IsSet(b, 16) && IsSet(b, 17) && IsSet(b, 30) && IsSet(b, 31);
  features.vnni = features.avx512 && IsSet(c, 11);
  const bool has_amx = IsSet(d, 22) && IsSet(d, 24);  // BF16, TILE
  if (__get_cpuid_count(7, 1, &a, &b, &c, &d) == 0) return features;
  features.bfloat16 = features.avx512 && IsSet(a, 5);
  features.amx = features.bfloat16 && has_amx && (saved & kTiles) == kTiles;
  return features;
}

BFloat16Unit FindBFloat16Unit() {
  const Features features = FindFeatures();
  if (!features.bfloat16) return BFloat16Unit::kNone;
  return features.amx && AskForTiles() ? BFloat16Unit::kAmx : BFloat16Unit::kAvx512;
}

ByteUnit ReadByteUnit() { return FindFeatures().vnni ? ByteUnit::kVnni : ByteUnit::kNone; }

#elif defined(__aarch64__) && defined(__linux__)

BFloat16Unit FindBFloat16Unit() { return BFloat16Unit::kNone; }

ByteUnit ReadByteUnit() {
  constexpr unsigned long kDotProduct = 1UL << 20;  // HWCAP_ASIMDDP of asm/hwcap.h
  return (getauxval(AT_HWCAP) & kDotProduct) != 0 ? ByteUnit::kDotProduct : ByteUnit::kNone;
}

#else

BFloat16Unit FindBFloat16Unit() { return BFloat16Unit::kNone; }

ByteUnit ReadByteUnit() { return ByteUnit::kNone; }

#endif

}  // namespace

BFloat16Unit BestBFloat16Unit() {
  static const BFloat16Unit unit = FindBFloat16Unit();
  return unit;
}

ByteUnit FindByteUnit() {
  static const ByteUnit unit = ReadByteUnit();
  return unit;
}

}  // namespace orb360::nn
