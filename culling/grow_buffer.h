// A buffer that grows and never shrinks, so that a frame like one seen before allocates nothing.
// One rule: growing forgets the contents unless asked to keep them; growth is counted.
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace throng {

template <typename T>
class GrowBuffer {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  GrowBuffer() = default;
  GrowBuffer(GrowBuffer&& other) noexcept { swap(other); }
  GrowBuffer& operator=(GrowBuffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~GrowBuffer() { release(); }

  /// Room for `count` elements, contents undefined.
  void resize(size_t count) { reserve(count, 0); }
  /// Room for `count` elements, the first `kept` of them kept.
  void grow(size_t count, size_t kept) { reserve(count, kept); }
  /// As much room as another buffer has, contents undefined.
  void match(const GrowBuffer& other) {
    if (other.capacity_ > capacity_) allocate(other.capacity_, 0);
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](size_t i) { return data_[i]; }
  const T& operator[](size_t i) const { return data_[i]; }
  size_t capacity() const { return capacity_; }
  uint32_t times_grown() const { return times_grown_; }

 private:
  static constexpr size_t kAlignment = 64;  // a cache line, and the widest register
  /// From here on in huge pages, where the system has them: a frame walks through all of it.
  static constexpr size_t kHugePage = size_t{2} << 20;

  void reserve(size_t count, size_t kept) {
    if (count <= capacity_) return;
    // A quarter in reserve: crowds get denser a little at a time.
    allocate(count + count / 4 + 16, kept);
  }
  void allocate(size_t capacity, size_t kept) {
    const bool huge = capacity * sizeof(T) >= 2 * kHugePage;
    const std::align_val_t alignment{huge ? kHugePage : kAlignment};
    T* data = static_cast<T*>(::operator new(capacity * sizeof(T), alignment));
    if (huge) madvise(data, capacity * sizeof(T) / kHugePage * kHugePage, MADV_HUGEPAGE);
    if (kept > 0) std::memcpy(static_cast<void*>(data), data_, kept * sizeof(T));
    release();
    data_ = data;
    alignment_ = alignment;
    capacity_ = capacity;
    ++times_grown_;
  }
  void release() {
    if (data_ != nullptr) ::operator delete(data_, alignment_);
  }
  void swap(GrowBuffer& other) {
    std::swap(data_, other.data_);
    std::swap(alignment_, other.alignment_);
    std::swap(capacity_, other.capacity_);
    std::swap(times_grown_, other.times_grown_);
  }

  T* data_ = nullptr;
  std::align_val_t alignment_{kAlignment};
  size_t capacity_ = 0;
  uint32_t times_grown_ = 0;
};

}  // namespace throng
