// NearestParts reduces proximity rows to the nearest parts of each two bodies, and lists those of
// one body for the page. Invariant: distances and points are those of the rows.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "lcm_io/codec/run_reader.h"
#include "viewer/server/run_message.h"

namespace throng {

/// Returns the nearest parts of each two bodies in the newest proximity rows of `run`, by pair.
/// The least lower bound decides, then the least upper bound. `body`: only rows of this one.
std::vector<ProximityPair> nearest_parts(const RunReader& run,
                                         std::optional<uint32_t> body = std::nullopt);

/// Returns whether both closest points of a row are known.
bool has_points(const ProximityPair& row);

/// Start of a proximity message: head | records by frame | zeros to a multiple of 8 | points. Each
/// record with points has f64 x, y, z of the point of the body, then of the other one's.
struct ProximityHead {
  uint32_t kind = kProximityMessage;
  uint32_t count = 0;
  uint32_t body = 0;
  uint32_t is_recorded = 0;  ///< 0: the run has no proximity rows so far
  double from = 0, to = 0;   ///< the records cover frames from <= frame < to
};
static_assert(sizeof(ProximityHead) == 32);

struct ProximityRecord {
  int32_t frame;
  uint32_t other;
  uint8_t part, other_part;  ///< kWholeBody: not refined to parts
  uint8_t level;
  uint8_t has_points;
  float lo_m, hi_m;  ///< bounds of the distance
};
static_assert(sizeof(ProximityRecord) == 20);

/// ProximityMessage collects the rows of one body, frame by frame.
class ProximityMessage {
 public:
  ProximityMessage(uint32_t body, int64_t from);

  /// `rows`: pairs of the body in a frame.
  void add(int64_t frame, std::span<const ProximityPair> rows);
  size_t size() const { return head_.count; }
  /// `to`: the frame after the last one that the rows cover.
  Bytes finish(int64_t to, bool is_recorded);

 private:
  ProximityHead head_;
  Bytes records_;
  std::vector<double> points_;
};

/// ProximityHistory keeps the nearest parts of the newest frames of a live run. Thread-safe.
class ProximityHistory {
 public:
  explicit ProximityHistory(size_t capacity = 200'000) : capacity_(capacity) {}

  /// Takes the newest proximity rows of `run`; frames in ascending order.
  void add(const RunReader& run);
  void clear();
  /// Returns a proximity message of the stored frames from `since` on.
  Bytes of(uint32_t body, int64_t since) const;

 private:
  struct Entry {
    int64_t frame;
    std::vector<ProximityPair> rows;
  };
  size_t capacity_;
  mutable std::mutex mutex_;
  std::deque<Entry> entries_;
  size_t rows_ = 0;
};

}  // namespace throng
