// RecordedSamples maps stored samples to those of a recording: instants to seconds, shifted
// positions, the requested time range, one sample per instant.
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
  double origin = 0;
  double per_s = 1;
  double grid_per_s = 0;  ///< frames per second of the grid that times are rounded to; 0: no grid
  double same_within_s = 0;  ///< closer instants count as equal
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  /// Requested range of instants, both ends included.
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();

  double time_s(double instant) const;
};

struct Duplicates {
  int64_t count = 0;  ///< excludes equal positions if equal instants are merged
  double first_s = 0;
};

class RecordedSamples {
 public:
  RecordedSamples(std::unique_ptr<const SampleStore> store, const SampleMapping& mapping)
      : store_(std::move(store)), mapping_(mapping) {}

  const SampleStore& store() const { return *store_; }
  const SampleMapping& mapping() const { return mapping_; }
  /// Sets the order of people, by their numbers in the store.
  void order(std::vector<uint32_t> people) { people_ = std::move(people); }
  void read(size_t person, std::vector<Sample>& out) const { read_stored(people_[person], out); }
  /// By the number in the store; returns the dropped duplicates.
  Duplicates read_stored(size_t person, std::vector<Sample>& out) const;

 private:
  std::unique_ptr<const SampleStore> store_;
  SampleMapping mapping_;
  std::vector<uint32_t> people_;
};

}  // namespace throng
