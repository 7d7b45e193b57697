// LogHead is the header of an event in an LCM log file, big-endian, with its encoder and decoder.
#pragma once

#include <cstddef>
#include <cstdint>

namespace throng {

inline constexpr uint32_t kLogMagic = 0xEDA1DA01;
inline constexpr size_t kLogHeadBytes = 28;
inline constexpr int32_t kMaxChannelBytes = 63;
/// Far above any message of Throng, and far below sizes that crash LCM's reader.
inline constexpr int32_t kMaxDataBytes = 16 << 20;

struct LogHead {
  int64_t number = 0;
  int64_t stamp_us = 0;
  int32_t channel_bytes = 0;
  int32_t data_bytes = 0;
};

template <class Integer>
void put_big_endian(uint8_t* out, Integer value) {
  for (size_t i = 0; i < sizeof value; ++i)
    out[i] = static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * (sizeof value - 1 - i)));
}

template <class Integer>
Integer get_big_endian(const uint8_t* in) {
  uint64_t value = 0;
  for (size_t i = 0; i < sizeof(Integer); ++i) value = value << 8 | in[i];
  return static_cast<Integer>(value);
}

inline void put_log_head(uint8_t* out, const LogHead& head) {
  put_big_endian(out, kLogMagic);
  put_big_endian(out + 4, head.number);
  put_big_endian(out + 12, head.stamp_us);
  put_big_endian(out + 20, head.channel_bytes);
  put_big_endian(out + 24, head.data_bytes);
}

/// Returns false without the magic number.
inline bool get_log_head(const uint8_t* in, LogHead& head) {
  head.number = get_big_endian<int64_t>(in + 4);
  head.stamp_us = get_big_endian<int64_t>(in + 12);
  head.channel_bytes = get_big_endian<int32_t>(in + 20);
  head.data_bytes = get_big_endian<int32_t>(in + 24);
  return get_big_endian<uint32_t>(in) == kLogMagic;
}

}  // namespace throng
