// counting_sort() groups items by a small integer key, stable, in two passes over the items.
// Invariant: it allocates nothing; the caller owns every buffer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace throng {

/// each(visit) calls visit(item) for every item, twice in the same order; key_of(item) < keys.
/// place(item, position) is then called once per item, items of equal key in the order of each().
/// `start` has keys + 2 entries; group k ends up at positions [start[k], start[k + 1]).
template <typename Each, typename KeyOf, typename Place>
void counting_sort(size_t keys, uint32_t* start, const Each& each, const KeyOf& key_of,
                   const Place& place) {
  // Shifted by one group; after placing, start[k] is the begin of group k.
  std::fill_n(start, keys + 2, 0u);
  each([&](const auto& item) { ++start[static_cast<size_t>(key_of(item)) + 2]; });
  std::partial_sum(start, start + keys + 2, start);
  each([&](const auto& item) { place(item, start[static_cast<size_t>(key_of(item)) + 1]++); });
}

/// Sorts the items 0 .. count - 1.
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
