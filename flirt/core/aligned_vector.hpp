// flirt/core/aligned_vector.hpp: vectors whose first element begins a cache line, for what is read many vectors of 64
// bytes at a time: one that lies across two lines costs twice.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace flirt {

template <class T>
struct AlignedAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): containers ask for it by this name
  static constexpr std::align_val_t alignment{64};

  AlignedAllocator() = default;
  template <class Other>
  // NOLINTNEXTLINE(google-explicit-constructor): containers convert allocators
  AlignedAllocator(const AlignedAllocator<Other>& /*other*/) {}

  [[nodiscard]] T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
  void deallocate(T* first, std::size_t /*count*/) { ::operator delete(first, alignment); }

  friend bool operator==(const AlignedAllocator& /*a*/, const AlignedAllocator& /*b*/) { return true; }
};

template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

}  // namespace flirt
