// From what a store holds to what a recording says: instants to seconds, places shifted, the part
// of the time that was asked for, one sample an instant.
// One rule: everybody who reads a recording's samples reads them here.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "recordings/recording.h"
#include "recordings/sample_store.h"

namespace throng {

struct SampleMapping {
  double origin = 0;         ///< the instant that is 0 s
  double per_s = 1;          ///< instants in a second
  double grid_per_s = 0;     ///< times are those of so many frames a second; 0: as they are
  double same_within_s = 0;  ///< as near as that is the same instant
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  /// Of instants, what is kept; both ends belong to it.
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();

  double time_s(double instant) const;
};

/// Samples beyond the first of their instant.
struct Duplicates {
  int64_t count = 0;  ///< not those at the same place where equal ones are merged
  double first_s = 0;
};

class RecordedSamples {
 public:
  RecordedSamples(std::unique_ptr<const SampleStore> store, const SampleMapping& mapping)
      : store_(std::move(store)), mapping_(mapping) {}

  const SampleStore& store() const { return *store_; }
  const SampleMapping& mapping() const { return mapping_; }
  /// People in the order in which they are asked for, by their numbers in the store.
  void order(std::vector<uint32_t> people) { people_ = std::move(people); }
  void read(size_t person, std::vector<Sample>& out) const { read_stored(people_[person], out); }
  /// By the number in the store.
  Duplicates read_stored(size_t person, std::vector<Sample>& out) const;

 private:
  std::unique_ptr<const SampleStore> store_;
  SampleMapping mapping_;
  std::vector<uint32_t> people_;
};

}  // namespace throng
