// PairBegins tracks since when each pair touches; PairHistory stores past contacts.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "lcm_io/codec/run_reader.h"
#include "viewer/server/run_message.h"

namespace throng {

// Invariant of PairBegins: a begin that was not received has no frame, only an upper bound.

/// The frame of a begin; if the begin was not received, ~F: the pair began before frame F.
using BeginFrame = int64_t;
constexpr BeginFrame began_before(int64_t frame) { return ~(frame > 0 ? frame : 0); }

/// Frame or BeginFrame in a message for the page. Saturates damaged numbers.
int32_t to_int32(int64_t frame);

class PairBegins {
 public:
  enum class ChangeKind : uint8_t {
    kBegan,
    kEnded,
    kLost  ///< messages are missing: it is unknown whether and when the contact ended
  };
  struct Change {
    PairKey pair;
    ChangeKind kind;
    int64_t frame;  ///< first frame in which it holds
    BeginFrame began;
    Eigen::Vector2f place_m = unknown_place();  ///< see ContactRecord::x_m
    void set_place(const CrowdState& crowd);
  };
  static Eigen::Vector2f unknown_place() {
    return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
  }
  using Begins = std::map<PairKey, BeginFrame>;

  /// Call after run.take() returned `update`. Returns whether a new run began, which clears all.
  bool take(const RunReader& run, RunReader::Update update);

  std::span<const Change> changes() const { return changes_; }
  /// Begin frames of the touching pairs, in the order of RunReader::touching().
  const Begins& all() const { return begins_; }

  /// Replaces the begins, after a player of `run` has jumped.
  void set(Begins begins, const RunReader& run);

 private:
  bool update_begins(const RunReader& run, RunReader::Update update);
  void begin(PairKey pair, int64_t frame, BeginFrame began);
  void mark_lost(int64_t frame);
  void match(const RunReader::Touching& touching, int64_t frame);

  Begins begins_;
  std::vector<Change> changes_;
  int64_t missing_ = 0;
  int64_t run_id_ = 0, instance_ = 0;
  bool has_run_ = false;
};

/// Start of a contacts message: head | records, in order of their sequence numbers. Changes are
/// numbered from 0 at the begin of a run. A page requests the changes from first + count on. A
/// greater `first` in the answer: the changes between were discarded, or lie before the query's
/// `since`. A smaller one: a new run began.
struct ContactsHead {
  uint32_t kind = kContactsMessage;
  uint32_t count = 0;
  double first = 0;   ///< number of the first record; `known` if there is none
  double known = 0;   ///< number that the next change will have
  double frame = -1;  ///< newest frame whose changes are all known; -1: none
};
static_assert(sizeof(ContactsHead) == 32);

/// One change of a pair. Each contact has a record of its begin before one of its end or loss,
/// unless the former was discarded.
struct ContactRecord {
  int32_t frame;           ///< first frame in which the change holds
  int32_t began;           ///< the BeginFrame of the contact
  uint32_t a, b;           ///< ids of the bodies, a < b: avatars, then obstacles
  uint8_t part_a, part_b;  ///< kWholeBody: not refined to parts
  uint8_t kind;            ///< a PairBegins::ChangeKind: 0 began, 1 ended, 2 lost
  uint8_t zero;
  float x_m, y_m;  ///< middle of both avatars by the newest states, or place of the one; NaN: none
};
static_assert(sizeof(ContactRecord) == 28);

/// PairHistory stores the begins and ends of contacts for queries of the page. Its size is bounded:
/// the oldest entries are discarded and counted.
class PairHistory {
 public:
  explicit PairHistory(size_t capacity = size_t{2} << 20) : capacity_(capacity) {}

  /// Call from one thread; the const functions are thread-safe.
  void add(std::span<const PairBegins::Change> changes);
  /// States that all changes up to `frame` were added. Places of its changes follow its states,
  /// which come after its events.
  void complete(int64_t frame, const CrowdState& crowd = {});
  void clear();

  /// Returns the newest `max` pairs of a body that began at or before `frame`, newest first:
  /// {"history": id, "frame": frame, "discarded": n,
  ///  "pairs": [[BeginFrame, end or -1, a, b, part_a, part_b], ...]}.
  std::string of(uint32_t body, int64_t frame, size_t max) const;

  /// Returns a contacts message with up to `max` changes, without those before sequence number
  /// `first` or before the first change in frame `since` or later. Discarded changes are left out.
  Bytes changes_from(uint64_t first, int64_t since, size_t max) const;

  /// Returns the begin frames of pairs that touch at `frame`.
  PairBegins::Begins begins_at(int64_t frame, const RunReader::Touching& touching) const;

 private:
  size_t capacity_;
  mutable std::mutex mutex_;
  std::deque<PairBegins::Change> entries_;
  uint64_t discarded_ = 0;  ///< sequence number of the oldest entry
  int64_t complete_ = -1;   ///< newest complete frame
  int64_t known_from_ = 0;  ///< nothing was discarded from this frame on
};

}  // namespace throng
