#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <utility>

namespace orb360 {

/// The values of the keys that were asked for last, first in, first out. For values whose copies
/// share their data.
template <typename Value>
class FifoCache {
 public:
  /// \param capacity Number of values that are kept, at least 1.
  /// \param make Makes the value of a key; what it throws is passed on.
  FifoCache(std::size_t capacity, std::function<Value(std::size_t)> make)
      : capacity_(capacity), make_(std::move(make)) {}

  Value Get(std::size_t key) {
    const auto found = std::ranges::find(entries_, key, &Entry::key);
    if (found != entries_.end()) return found->value;
    Value value = make_(key);
    if (entries_.size() >= capacity_) entries_.pop_front();
    entries_.push_back({key, value});
    return value;
  }

 private:
  struct Entry {
    std::size_t key;
    Value value;
  };

  std::size_t capacity_;
  std::function<Value(std::size_t)> make_;
  std::deque<Entry> entries_;
};

}  // namespace orb360
