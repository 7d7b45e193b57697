// GrowBuffer is a buffer that grows and never shrinks; THRONG_PREFETCH marks prefetch functions.
// Invariant: a frame that needs no more elements than an earlier one allocates nothing.
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

/// For functions that only prefetch. They are inlined early, because GCC drops calls of functions
/// without effect.
#define THRONG_PREFETCH [[gnu::always_inline]] inline

namespace throng {

/// Bytes, on most processors.
inline constexpr size_t kCacheLine = 64;

/// Growing discards the contents unless asked to keep them; growth is counted.
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

  /// Capacity for `count` elements, contents undefined.
  void resize(size_t count) { reserve(count, 0); }
  /// Capacity for `count` elements; keeps the first `kept`.
  void grow(size_t count, size_t kept) { reserve(count, kept); }
  /// The capacity of another buffer, contents undefined.
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
  static constexpr size_t kAlignment = kCacheLine;  // also the widest register
  /// From this size on the buffer has its own pages, which mremap moves without copying; only new
  /// pages cost a fault. Smaller buffers, and all under the address sanitizer, use the allocator.
#ifdef __SANITIZE_ADDRESS__
  static constexpr size_t kMinMappedBytes = std::numeric_limits<size_t>::max();
#else
  static constexpr size_t kMinMappedBytes = size_t{256} << 10;
#endif

  void reserve(size_t count, size_t kept) {
    if (count <= capacity_) return;
    // A quarter in reserve: crowds get denser gradually.
    allocate(count + count / 4 + 16, kept);
  }
  bool is_mapped() const { return capacity_ * sizeof(T) >= kMinMappedBytes; }
  void allocate(size_t capacity, size_t kept) {
    const size_t bytes = capacity * sizeof(T);
    if (is_mapped()) {
      data_ = checked(mremap(data_, capacity_ * sizeof(T), bytes, MREMAP_MAYMOVE));
    } else {
      T* const data = bytes >= kMinMappedBytes
                          ? checked(mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                                         MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))
                          : static_cast<T*>(::operator new (bytes, std::align_val_t{kAlignment}));
      if (kept > 0) std::memcpy(static_cast<void*>(data), data_, kept * sizeof(T));
      release();
      data_ = data;
    }
    capacity_ = capacity;
    ++times_grown_;
  }
  static T* checked(void* pages) {
    if (pages == MAP_FAILED) throw std::bad_alloc();
    return static_cast<T*>(pages);
  }
  void release() {
    if (is_mapped())
      munmap(data_, capacity_ * sizeof(T));
    else if (data_ != nullptr)
      ::operator delete (data_, std::align_val_t{kAlignment});
  }
  void swap(GrowBuffer& other) {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    std::swap(times_grown_, other.times_grown_);
  }

  T* data_ = nullptr;
  size_t capacity_ = 0;
  uint32_t times_grown_ = 0;
};

}  // namespace throng
