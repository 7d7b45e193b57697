// A temporary file without a name, for what is larger than memory should be.
// One rule: it goes with the process, however that ends; pages that the system caches are its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace throng {

class NamelessFile {
 public:
  /// In $TMPDIR, or /tmp. Throws EnvironmentError, as the others, naming the folder and the way
  /// out.
  NamelessFile();
  ~NamelessFile();
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;

  /// From several threads at once, for parts that do not overlap.
  void write(int64_t offset, std::span<const std::byte> bytes);
  /// The same; all of it has been written.
  void read(int64_t offset, std::span<std::byte> bytes) const;

 private:
  int descriptor_ = -1;
};

}  // namespace throng
