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
};

/// Maximum number of pairs in an answer about one person.
inline constexpr size_t kHistoryPairs = 40;

/// Returns an empty query if the text is none of these.
ViewQuery parse_view_query(std::string_view text);

}  // namespace throng
