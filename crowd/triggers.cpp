#include "crowd/triggers.h"

#include <algorithm>
#include <limits>

namespace throng {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

}  // namespace

Triggers::Triggers(const NavigationMap& map, std::span<const AgentSpec> people) : map_(map) {
  for (uint32_t id = 0; id < people.size(); ++id) {
    if (people[id].is_external) continue;  // no trigger refers to its group
    if (members_.size() <= people[id].group) members_.resize(people[id].group + 1);
    Range& range = members_[people[id].group];
    if (range.end == 0) range.begin = id;
    range.end = id + 1;
  }
  for (const Trigger& trigger : map.triggers())
    times_s_.push_back(trigger.group ? kUnknown : trigger.delay_s);
}

void Triggers::archive(Archive& a) {
  a(times_s_);
  // Negated to reject NaN as well.
  for (const double time_s : times_s_)
    if (!(time_s >= 0)) a.reject("a time from the start on", "another value");
}

void Triggers::watch(const Journeys& journeys, double now_s) {
  for (size_t i = 0; i < times_s_.size(); ++i) {
    if (times_s_[i] < kUnknown) continue;
    const Trigger& trigger = map_.triggers()[i];
    bool all_have = true;
    if (*trigger.group < members_.size()) {
      const Range& people = members_[*trigger.group];
      for (uint32_t id = people.begin; id < people.end && all_have; ++id)
        all_have = journeys.has_visited(id, trigger.goals);
    }
    if (all_have) times_s_[i] = now_s + trigger.delay_s;
  }
}

}  // namespace throng
