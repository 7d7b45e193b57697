// put() appends numbers to a message for the page, little-endian as typed arrays read them.
// Invariant: the data of a typed array starts at a multiple of its element size.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace throng {

static_assert(std::endian::native == std::endian::little, "bytes are copied as they lie");

using Bytes = std::vector<uint8_t>;

template <typename Number>
void put(Bytes& out, Number value) {
  const size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

template <typename Number>
void put_all(Bytes& out, std::span<const Number> values) {
  const size_t at = out.size();
  out.resize(at + values.size_bytes());
  if (!values.empty()) std::memcpy(out.data() + at, values.data(), values.size_bytes());
}

/// Appends zeros up to a multiple of `size`.
inline void align(Bytes& out, size_t size) { out.resize((out.size() + size - 1) / size * size); }

}  // namespace throng
