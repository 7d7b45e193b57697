// A file that somebody named, opened only if it is one that ends.
// One rule: what is no regular file (a pipe, a device, a folder) is never opened, not even for a
// moment, and what was judged is what is read: there is no time between look and use in which
// another file could take the name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

class RegularFile {
 public:
  /// Throws InputError "PATH: expected EXPECTED, found a named pipe" (a device, nothing, more than
  /// `max_bytes`, something that may not be read).
  RegularFile(const std::filesystem::path& path, std::string_view expected, uint64_t max_bytes);
  ~RegularFile();
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Open for reading, above standard error's, closed on exec.
  int descriptor() const { return descriptor_; }
  /// As it was when it was opened.
  uint64_t size() const { return size_; }
  /// All of it. Throws InputError if it cannot be read or has become shorter; what was added since
  /// is left out.
  std::vector<uint8_t> bytes() const;
  void read(std::span<std::byte> out) const;  ///< the first bytes, as many as asked for

 private:
  std::filesystem::path path_;
  std::string expected_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace throng
