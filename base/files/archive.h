// Archive writes state to bytes and reads it back, for checkpoints.
// Invariant: a struct lists its fields once, in archive(), for both directions. Reading validates:
// a short, long or mismatching archive is an InputError.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace throng {

class Archive;

/// A struct that lists its fields: `void archive(Archive& a) { a(x_, y_); }`.
template <typename T>
concept Archived = requires(T& value, Archive& archive) {
  value.archive(archive);
};

class Archive {
 public:
  /// Writes fields.
  Archive() = default;
  /// Reads fields, in the order in which they were written. `name` is for errors.
  Archive(std::span<const uint8_t> bytes, std::string name)
      : is_reading_(true), input_(bytes), name_(std::move(name)) {}

  bool is_reading() const { return is_reading_; }
  const std::vector<uint8_t>& bytes() const { return output_; }
  /// Throws InputError unless everything was read.
  void expect_end() const;
  /// Throws InputError for an impossible value.
  [[noreturn]] void reject(const std::string& expected, const std::string& found) const;

  /// Archives the fields in order. A vector must already have its archived length: resuming builds
  /// the same run first.
  template <typename... Fields>
  void operator()(Fields&... fields) {
    (field(fields), ...);
  }

  /// Resizes the vector to the archived length, at most `max_count` elements.
  template <typename T>
  void resized(std::vector<T>& values, size_t max_count) {
    uint64_t count = values.size();
    field(count);
    if (is_reading_) {
      if (count > max_count) reject_length(max_count, count);
      expect_available(count);
      values.resize(static_cast<size_t>(count));
    }
    for (T& value : values) field(value);
  }

 private:
  template <typename T>
  void field(T& value) {
    if constexpr (Archived<T>) {
      value.archive(*this);
    } else if constexpr (std::same_as<T, bool>) {
      auto byte = static_cast<uint8_t>(value);
      number(byte);
      if (byte > 1) reject("0 or 1", std::to_string(byte));
      value = byte != 0;
    } else if constexpr (std::is_enum_v<T>) {
      auto word = static_cast<std::underlying_type_t<T>>(value);
      number(word);
      value = static_cast<T>(word);
    } else {
      number(value);
    }
  }
  template <typename T, int rows, int columns>
  void field(Eigen::Matrix<T, rows, columns>& value) {
    static_assert(rows > 0 && columns > 0, "only matrices of fixed size");
    for (int i = 0; i < rows * columns; ++i) number(value.data()[i]);
  }
  template <typename T>
  void field(Eigen::Quaternion<T>& value) {
    field(value.coeffs());
  }
  template <typename T, size_t count>
  void field(std::array<T, count>& values) {
    for (T& value : values) field(value);
  }
  template <typename T, size_t count>
  void field(T (&values)[count]) {
    for (T& value : values) field(value);
  }
  template <typename T>
  void field(std::vector<T>& values) {
    uint64_t count = values.size();
    field(count);
    if (count != values.size()) reject_length(values.size(), count);
    for (T& value : values) field(value);
  }

  /// Little-endian on every machine.
  template <typename T>
  void number(T& value) {
    static_assert(std::is_arithmetic_v<T>, "give the type its own archive()");
    if constexpr (std::is_floating_point_v<T>) {
      using Bits = std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>;
      auto bits = std::bit_cast<Bits>(value);
      number(bits);
      value = std::bit_cast<T>(bits);
    } else {
      auto bits = static_cast<uint64_t>(value);
      word(bits, sizeof(T));
      value = static_cast<T>(bits);
    }
  }
  void word(uint64_t& bits, size_t bytes);
  void expect_available(uint64_t elements) const;
  [[noreturn]] void reject_length(uint64_t expected, uint64_t found) const;

  bool is_reading_ = false;
  std::span<const uint8_t> input_;
  size_t next_ = 0;
  std::string name_;
  std::vector<uint8_t> output_;
};

}  // namespace throng
