#include "crowd/occasions.h"

#include <algorithm>
#include <limits>

namespace throng {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

}  // namespace

Occasions::Occasions(const Ways& ways, std::span<const Person> people) : ways_(ways) {
  for (uint32_t id = 0; id < people.size(); ++id) {
    if (people[id].is_led) continue;  // of a group that nothing waits for
    if (people_of_.size() <= people[id].group) people_of_.resize(people[id].group + 1);
    Range& range = people_of_[people[id].group];
    if (range.end == 0) range.begin = id;
    range.end = id + 1;
  }
  for (const Occasion& occasion : ways.occasions())
    times_s_.push_back(occasion.group ? kUnknown : occasion.later_s);
}

void Occasions::archive(Archive& a) {
  a(times_s_);
  // Written so that NaN is refused, too.
  for (const double time_s : times_s_)
    if (!(time_s >= 0)) a.refuse("a time from the start on", "another");
}

void Occasions::watch(const Journeys& journeys, double now_s) {
  for (size_t i = 0; i < times_s_.size(); ++i) {
    if (times_s_[i] < kUnknown) continue;
    const Occasion& occasion = ways_.occasions()[i];
    bool have_all = true;
    if (*occasion.group < people_of_.size()) {
      const Range& people = people_of_[*occasion.group];
      for (uint32_t id = people.begin; id < people.end && have_all; ++id)
        have_all = journeys.has_been_at(id, occasion.goals);
    }
    if (have_all) times_s_[i] = now_s + occasion.later_s;
  }
}

}  // namespace throng
