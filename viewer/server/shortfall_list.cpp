#include "viewer/server/shortfall_list.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace throng {

void ShortfallList::take(int64_t frame, std::span<const ShortfallEvent> events) {
  for (const auto& [kind, shortfall] : events) {
    const auto is_open = [&s = shortfall](const Entry& entry) {
      return entry.end_frame < 0 && entry.shortfall.robot == s.robot &&
             entry.shortfall.person == s.person && entry.shortfall.region == s.region;
    };
    const auto open = std::find_if(entries_.rbegin(), entries_.rend(), is_open);
    const int64_t end = kind == EventKind::kEnd ? frame : -1;
    if (open != entries_.rend())
      *open = {shortfall, end};
    else if (entries_.size() < kCapacity)
      entries_.push_back({shortfall, end});
  }
}

nlohmann::json ShortfallList::to_json() const {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [shortfall, end] : entries_)
    all.push_back({shortfall.begin_frame, end, shortfall.robot, shortfall.person,
                   name_of(shortfall.region), shortfall.max_shortfall_m});
  return all;
}

}  // namespace throng
