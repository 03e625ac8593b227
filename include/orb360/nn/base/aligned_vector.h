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
  using value_type = T;                     ///< Type of the elements.
  static constexpr std::size_t kLine = 64;  ///< Bytes of a cache line.
  /// Bytes of a large page of x86-64 and of most Arm processors.
  static constexpr std::size_t kLargePage = 1 << 21;

  CacheLineAllocator() = default;
  /// Converts from the allocator of another type, as the standard requires.
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}  // NOLINT: conversion is what it is for

  /// Allocates memory for `count` elements. Throws std::bad_alloc.
  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    void* memory = ::operator new(bytes, Alignment(count));
#ifdef MADV_HUGEPAGE
    // This is a hint; memory works without it and on systems without such pages.
    if (bytes >= kLargePage) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  /// Releases memory that `allocate` returned for the same count.
  void deallocate(T* pointer, std::size_t count) { ::operator delete(pointer, Alignment(count)); }
  /// Returns the alignment of a block of `count` elements, bytes.
  static constexpr std::align_val_t Alignment(std::size_t count) {
    return std::align_val_t{count * sizeof(T) >= kLargePage ? kLargePage : kLine};
  }
  /// Allocators have no state, so that any of them can release the memory of another.
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

/// A vector whose elements begin at a multiple of the cache line.
template <typename T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace orb360::nn
