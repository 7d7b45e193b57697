// What a page may ask for. One rule: anything else is nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace throng {

struct ViewQuery {
  std::optional<int64_t> frame;    ///< {"frame": n}
  std::optional<uint32_t> person;  ///< {"history": id, "frame": n}: as it was known at frame n
  bool index = false;              ///< {"index": true}
};

/// So many pairs of one person are shown.
inline constexpr size_t kHistoryPairs = 40;

/// An empty question if the text is none of these.
ViewQuery parse_view_query(std::string_view text);

}  // namespace throng
