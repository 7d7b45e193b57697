#include "base/files/archive.h"

#include <fmt/format.h>

#include "base/errors.h"

namespace throng {

void Archive::word(uint64_t& bits, size_t bytes) {
  if (!is_reading_) {
    for (size_t i = 0; i < bytes; ++i) output_.push_back(static_cast<uint8_t>(bits >> (8 * i)));
    return;
  }
  if (input_.size() - next_ < bytes) reject("more bytes", "the end");
  bits = 0;
  for (size_t i = 0; i < bytes; ++i) bits |= uint64_t{input_[next_++]} << (8 * i);
}

/// An element takes at least a byte; rejects impossible lengths before allocating.
void Archive::expect_available(uint64_t elements) const {
  if (elements > input_.size() - next_)
    reject(fmt::format("{} more elements", elements), "the end");
}

void Archive::reject_length(uint64_t expected, uint64_t found) const {
  reject(fmt::format("{} elements", expected), fmt::format("{}", found));
}

void Archive::reject(const std::string& expected, const std::string& found) const {
  throw InputError(is_reading_ ? fmt::format("{}: byte {}", name_, next_) : "archive", expected,
                   found);
}

void Archive::expect_end() const {
  if (is_reading_ && next_ != input_.size())
    reject("the end", fmt::format("{} more bytes", input_.size() - next_));
}

}  // namespace throng
