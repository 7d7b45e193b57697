// parse_view_query() reads a request of the page. Invariant: any other text is an empty query.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace throng {

struct ViewQuery {
  std::optional<int64_t> frame;    ///< {"frame": n}
  std::optional<uint32_t> person;  ///< {"history": id, "frame": n}: contacts known at frame n
  bool index = false;              ///< {"index": true}
  /// {"contacts": n}: the changes of all pairs from sequence number n on, as ContactsHead states.
  /// {"contacts": n, "since": frame}: those in this frame or later.
  std::optional<uint64_t> contacts;
  std::optional<int64_t> since;
  /// {"proximity": id, "since": frame}: the nearest parts of the others from this frame on, as
  /// ProximityHead states. The answer may end early; a page requests the rest with another query.
  std::optional<uint32_t> proximity;
  /// {"positions": first, "to": last, "every": n}: positions of all avatars in frames from `first`
  /// to `to`, at least `every` frames apart, as PositionsHead states. The answer may end early.
  std::optional<int64_t> positions;
  int64_t to = 0, every = 1;
};

/// Maximum number of pairs in an answer about one person.
inline constexpr size_t kHistoryPairs = 40;
/// Maximum number of changes in a contacts message, which takes up to 1 MB. A page requests the
/// rest with another query. WebClient bounds the number of answers that wait for a slow page.
inline constexpr size_t kMaxContacts = 50'000;

/// Returns an empty query if the text is none of these.
ViewQuery parse_view_query(std::string_view text);

}  // namespace throng
