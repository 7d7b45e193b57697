// Where the samples of a recording lie: a temporary file without a name in $TMPDIR.
// One rule: memory grows with the people, never with their samples, in whatever order they come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/files/anonymous_file.h"

namespace throng {

/// As a file has it, in metres.
struct StoredSample {
  double instant = 0;  ///< a frame's number, or seconds
  double x_m = 0, y_m = 0;
  float z_m = 0, heading_rad = 0;  ///< none: NaN
};

/// People are numbered in the order in which they came. First all is added, then finished, then
/// read, by any number of threads. Throws EnvironmentError, with the way out, where the file cannot
/// be written or read.
class SampleStore {
 public:
  SampleStore();

  /// The number of somebody new.
  size_t add_person();
  void add(size_t person, const StoredSample& sample);
  void finish();

  size_t people() const { return chains_.size(); }
  int64_t count(size_t person) const { return chains_[person].count; }
  /// In ascending order of instants; those at the same one in the order in which they came.
  void read(size_t person, std::vector<StoredSample>& out) const;

 private:
  /// Samples of a person in the file are blocks, each of which names the one before.
  struct BlockHead {
    int64_t before = -1;  ///< where it begins in the file; -1: none
    int64_t count = 0;
  };
  static constexpr size_t kBlockSamples = 64;
  static constexpr size_t kBlockBytes = sizeof(BlockHead) + kBlockSamples * sizeof(StoredSample);
  /// Blocks being filled, 64 MiB of them: beyond, all go to the file as full as they are.
  static constexpr size_t kMaxStaged = 32'768;
  static constexpr size_t kWriteBytes = 1 << 20;
  static constexpr uint32_t kNotStaged = ~uint32_t{0};

  struct Chain {
    int64_t last_block = -1;
    int64_t count = 0;
    double last_instant = 0;
    uint32_t staged = kNotStaged;
    uint16_t staged_count = 0;
    bool is_shuffled = false;
  };

  void stage(size_t person);
  void flush(Chain& chain);
  void flush_all();
  void write_out();

  AnonymousFile file_;
  int64_t written_ = 0;
  std::vector<std::byte> unwritten_;
  std::vector<Chain> chains_;
  std::vector<StoredSample> staged_;     ///< kBlockSamples a block
  std::vector<uint32_t> staged_people_;  ///< whose block it is
};

}  // namespace throng
