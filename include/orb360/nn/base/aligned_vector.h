#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include <sys/mman.h>

namespace orb360::nn {

/// Allocates memory at a multiple of the cache line, where the widest vectors are aligned too.
/// Large blocks begin at a multiple of a large page and ask for such pages, because touching small
/// pages for the first time takes longer than filling them.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::size_t kLine = 64;            // bytes
  static constexpr std::size_t kLargePage = 1 << 21;  // bytes, of x86-64 and most of Arm

  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}  // NOLINT: conversion is what it is for

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    void* memory = ::operator new(bytes, Alignment(count));
#ifdef MADV_HUGEPAGE
    // This is a hint; memory works without it and on systems without such pages.
    if (bytes >= kLargePage) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* pointer, std::size_t count) { ::operator delete(pointer, Alignment(count)); }
  static constexpr std::align_val_t Alignment(std::size_t count) {
    return std::align_val_t{count * sizeof(T) >= kLargePage ? kLargePage : kLine};
  }
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

template <typename T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace orb360::nn
