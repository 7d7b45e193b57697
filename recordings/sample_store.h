// SampleStore keeps the samples of a recording in an anonymous temporary file in $TMPDIR.
// Invariant: memory grows with the number of people, not of samples, regardless of their order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/files/anonymous_file.h"

namespace throng {

struct StoredSample {
  double instant = 0;  ///< frame number or seconds
  double x_m = 0, y_m = 0;
  float z_m = 0, heading_rad = 0;  ///< NaN: unknown
};

/// People are numbered in the order in which they are added. Add all samples, then call finish(),
/// then read; reading is thread-safe. Throws EnvironmentError with a remedy if the file cannot be
/// written or read.
class SampleStore {
 public:
  SampleStore();

  size_t add_person();
  void add(size_t person, const StoredSample& sample);
  void finish();

  size_t people() const { return chains_.size(); }
  int64_t count(size_t person) const { return chains_[person].count; }
  /// Reads samples in ascending order of instants; equal instants keep their order.
  void read(size_t person, std::vector<StoredSample>& out) const;

 private:
  /// Samples of a person are blocks in the file, each of which points to the previous one.
  struct BlockHeader {
    int64_t before = -1;  ///< offset of the previous block; -1: none
    int64_t count = 0;
  };
  static constexpr size_t kBlockSamples = 64;
  static constexpr size_t kBlockBytes = sizeof(BlockHeader) + kBlockSamples * sizeof(StoredSample);
  /// Maximum number of blocks being filled, 64 MiB; beyond it all of them are written.
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
  std::vector<StoredSample> staged_;
  std::vector<uint32_t> staged_people_;
};

}  // namespace throng
