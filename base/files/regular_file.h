// RegularFile opens an input file named by the user if it is a regular file.
// Invariant: pipes, devices and folders are never opened. The file that was checked is the file
// that is read; no other file can take its name in between.
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
  /// `max_bytes`, no permission).
  RegularFile(const std::filesystem::path& path, std::string_view expected, uint64_t max_bytes);
  ~RegularFile();
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Open for reading, above 2, closed on exec.
  int descriptor() const { return descriptor_; }
  /// Size in bytes when it was opened.
  uint64_t size() const { return size_; }
  /// Returns the bytes that were there at opening. Throws InputError if the file cannot be read or
  /// has become shorter.
  std::vector<uint8_t> bytes() const;
  void read(std::span<std::byte> out) const;  ///< the first out.size() bytes

 private:
  std::filesystem::path path_;
  std::string expected_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace throng
