// Groups items by a small integer key, stable, in two passes over the items.
// One rule: the caller owns every buffer, so that sorting allocates nothing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace throng {

/// each(visit) calls visit(item) for every item, twice in the same order; key_of(item) < keys.
/// Then place(item, position) is called once an item, items of equal key in the order of each().
/// start has keys + 2 entries; afterwards group k lies at positions [start[k], start[k + 1]).
template <typename Each, typename KeyOf, typename Place>
void counting_sort(size_t keys, uint32_t* start, const Each& each, const KeyOf& key_of,
                   const Place& place) {
  // Counted one group late, so that after placing start[k] is where group k begins.
  std::fill_n(start, keys + 2, 0u);
  each([&](const auto& item) { ++start[static_cast<size_t>(key_of(item)) + 2]; });
  std::partial_sum(start, start + keys + 2, start);
  each([&](const auto& item) { place(item, start[static_cast<size_t>(key_of(item)) + 1]++); });
}

/// The items 0 .. count - 1.
template <typename KeyOf, typename Place>
void counting_sort(size_t count, size_t keys, uint32_t* start, const KeyOf& key_of,
                   const Place& place) {
  counting_sort(
      keys, start,
      [count](const auto& visit) {
        for (size_t i = 0; i < count; ++i) visit(i);
      },
      key_of, place);
}

}  // namespace throng
