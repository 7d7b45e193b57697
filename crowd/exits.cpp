#include "crowd/exits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"

namespace throng {
namespace {

constexpr float kUnreachable_m = std::numeric_limits<float>::infinity();
/// So many look at once; a block of them for a worker takes some ten microseconds.
constexpr size_t kMostLookers = 4096;
constexpr size_t kLookersABlock = 64;
/// More a second come through no exit.
constexpr double kMostFlow_per_s = 1e6;

}  // namespace

uint32_t Approach::bin_of(float way_m) {
  constexpr float kFine_m = 64;
  const float bin = way_m < kFine_m ? 2 * way_m : 2 * kFine_m + 0.25f * (way_m - kFine_m);
  return static_cast<uint32_t>(std::clamp(bin, 0.0f, static_cast<float>(kBins - 1)));
}

void Approach::add(float way_m, int32_t people) {
  for (uint32_t at = bin_of(way_m) + 1; at <= kBins; at += at & (~at + 1)) sums_[at] += people;
}

int32_t Approach::below(uint32_t bin) const {
  int32_t sum = 0;
  for (uint32_t at = bin; at > 0; at &= at - 1) sum += sums_[at];
  return sum;
}

double Approach::ahead_of(float way_m) const {
  const uint32_t bin = bin_of(way_m);
  return 0.5 * (below(bin) + below(bin + 1));
}

Exits::Exits(const Ways& ways, std::span<const Person> people, uint64_t seed)
    : ways_(ways), seed_(seed) {
  for (const Exit& exit : ways.exits()) {
    State& state = states_.emplace_back();
    state.flow_per_s = std::max(tuning::kExitFlow_per_ms * exit.width_m, tuning::kLeastFlow_per_s);
  }
  if (!has_any()) return;
  for (size_t group = 0; group < ways.groups(); ++group)
    for (const Stop& stop : ways.route(group))
      most_exits_ = std::max<size_t>(most_exits_, stop.exits);
  approaches_.resize(states_.size());
  for (const Person& person : people)
    free_speeds_mps_.push_back(static_cast<float>(person.free_speed_mps));
  counted_.assign(people.size(), Journeys::kNoExit);
  ways_m_.assign(people.size(), 0);
  lookers_.reserve(people.size());
  looked_m_.resize(std::min(people.size(), kMostLookers) * most_exits_);
}

void Exits::archive(Archive& a) {
  a(counted_, ways_m_, states_);
  if (!a.is_reading()) return;
  // Written so that NaN is refused, too.
  for (const State& state : states_)
    if (!(state.flow_per_s >= tuning::kLeastFlow_per_s && state.flow_per_s <= kMostFlow_per_s))
      a.refuse("a flow through an exit", "another");
  for (const float way_m : ways_m_)
    if (!(way_m >= 0 && way_m < kUnreachable_m)) a.refuse("the length of a way", "another");
  for (const uint32_t exit : counted_)
    if (exit < Journeys::kOpen && exit >= states_.size()) a.refuse("an exit", "another");
}

void Exits::choose(uint64_t decision, std::span<const Eigen::Vector2d> positions_m,
                   std::span<const uint32_t> order, std::span<const uint8_t> queuing,
                   Journeys& journeys, Workers& workers) {
  count(journeys);
  const uint64_t turn = decision % tuning::kLooksAgain;
  if (turn == 0) watch(journeys, order, queuing);
  lookers_.clear();
  for (uint32_t id = 0; id < counted_.size(); ++id) {
    const uint32_t exit = journeys.exit(id);
    const bool looks_again = exit < Journeys::kOpen && id % tuning::kLooksAgain == turn &&
                             journeys.first_of_party(id) == id;
    if (exit == Journeys::kOpen || looks_again) lookers_.push_back(id);
  }
  for (size_t first = 0; first < lookers_.size(); first += kMostLookers) {
    const auto some =
        std::span(lookers_).subspan(first, std::min(kMostLookers, lookers_.size() - first));
    const auto blocks = static_cast<int>((some.size() + kLookersABlock - 1) / kLookersABlock);
    workers.for_blocks(blocks, [&](int block, int) {
      const size_t begin = static_cast<size_t>(block) * kLookersABlock;
      for (size_t i = begin; i < std::min(begin + kLookersABlock, some.size()); ++i) {
        const Stop& stop = journeys.stop(some[i]);
        for (uint32_t exit = 0; exit < stop.exits; ++exit)
          looked_m_[i * most_exits_ + exit] = static_cast<float>(
              ways_.exits()[stop.first_exit + exit].field->distance_m(positions_m[some[i]]));
      }
    });
    for (size_t i = 0; i < some.size(); ++i)
      choose_one(some[i], std::span(looked_m_).subspan(i * most_exits_, most_exits_), positions_m,
                 journeys);
  }
}

/// Where everybody heads for; who does not any more has arrived.
void Exits::count(const Journeys& journeys) {
  for (Approach& approach : approaches_) approach.clear();
  for (uint32_t id = 0; id < counted_.size(); ++id) {
    const uint32_t exit = journeys.exit(id);
    if (counted_[id] < Journeys::kOpen && exit != counted_[id]) {
      ++states_[counted_[id]].arrived;
      states_[counted_[id]].has_served = true;
    }
    counted_[id] = exit;
    if (exit < Journeys::kOpen) approaches_[exit].add(ways_m_[id], 1);
  }
}

/// Once a second: an exit with a queue shows what it lets through. Without one it lets through more
/// than comes.
void Exits::watch(const Journeys& journeys, std::span<const uint32_t> order,
                  std::span<const uint8_t> queuing) {
  for (State& state : states_) state.queuing = 0;
  for (size_t slot = 0; slot < order.size(); ++slot) {
    const uint32_t exit = journeys.exit(order[slot]);
    if (exit < Journeys::kOpen && queuing[slot] != 0) ++states_[exit].queuing;
  }
  for (State& state : states_) {
    const double more = state.arrived - state.flow_per_s;
    state.arrived = 0;
    const bool shows = state.has_served && state.queuing >= tuning::kQueues;
    if (!shows && more <= 0) continue;
    const double seen_s = tuning::kGuessed_s + state.watched_s;
    state.flow_per_s += more / std::min(seen_s + 1, tuning::kSeen_s);
    state.flow_per_s = std::max(state.flow_per_s, tuning::kLeastFlow_per_s);
    if (shows) ++state.watched_s;
  }
}

/// When somebody of this way expects to be through: not before being there, and not before those
/// who are nearer.
double Exits::expected_s(uint32_t exit, uint32_t id, float way_m) const {
  const double walks_s = static_cast<double>(way_m) / static_cast<double>(free_speeds_mps_[id]);
  return std::max(walks_s, approaches_[exit].ahead_of(way_m) / states_[exit].flow_per_s);
}

double Exits::patience_s(uint32_t id) const {
  return random_uniform({seed_, id, 0, Purpose::kPatience}, tuning::kLeastPatience_s,
                        tuning::kMostPatience_s);
}

void Exits::take(uint32_t id, uint32_t exit, float way_m, Journeys& journeys) {
  journeys.take_exit(id, exit);
  counted_[id] = exit;
  ways_m_[id] = way_m;
  approaches_[exit].add(way_m, 1);
}

/// Whoever stands too near a wall for the fields to know sees no way and goes on as before.
void Exits::choose_one(uint32_t id, std::span<const float> ways_m,
                       std::span<const Eigen::Vector2d> positions_m, Journeys& journeys) {
  const Stop& stop = journeys.stop(id);
  const uint32_t own = journeys.exit(id);
  const bool has_own = own < Journeys::kOpen;
  if (const uint32_t theirs = has_own ? own : exit_of_companions(id, journeys);
      theirs != own && ways_m[theirs - stop.first_exit] < kUnreachable_m)
    return take(id, theirs, ways_m[theirs - stop.first_exit], journeys);
  if (has_own) {
    approaches_[own].add(ways_m_[id], -1);
    if (ways_m[own - stop.first_exit] < kUnreachable_m) ways_m_[id] = ways_m[own - stop.first_exit];
  }
  const double own_s = has_own ? expected_s(own, id, ways_m_[id]) : 0;
  uint32_t best = own;
  double best_s = std::numeric_limits<double>::infinity();
  if (has_own) best_s = (1 - tuning::kBetter) * own_s - patience_s(id);
  for (uint32_t i = 0; i < stop.exits; ++i) {
    const uint32_t exit = stop.first_exit + i;
    if (exit == own || !(ways_m[i] < kUnreachable_m)) continue;
    const double expected = expected_s(exit, id, ways_m[i]);
    if (!(expected < best_s)) continue;
    best = exit;
    best_s = expected;
  }
  if (best == Journeys::kOpen) return;
  take(id, best, best == own ? ways_m_[id] : ways_m[best - stop.first_exit], journeys);
  if (has_own) lead_companions(id, positions_m, journeys);
}

uint32_t Exits::exit_of_companions(uint32_t id, const Journeys& journeys) const {
  const uint32_t first = journeys.first_of_party(id);
  for (uint32_t each = first; each < counted_.size() && journeys.first_of_party(each) == first;
       ++each)
    if (journeys.exit(each) < Journeys::kOpen && &journeys.stop(each) == &journeys.stop(id))
      return journeys.exit(each);
  return journeys.exit(id);
}

void Exits::lead_companions(uint32_t first, std::span<const Eigen::Vector2d> positions_m,
                            Journeys& journeys) {
  const uint32_t exit = journeys.exit(first);
  for (uint32_t each = first + 1; each < counted_.size() && journeys.first_of_party(each) == first;
       ++each) {
    const uint32_t before = journeys.exit(each);
    if (!(before < Journeys::kOpen) || before == exit) continue;
    if (&journeys.stop(each) != &journeys.stop(first)) continue;
    const auto way_m = static_cast<float>(ways_.exits()[exit].field->distance_m(positions_m[each]));
    if (!(way_m < kUnreachable_m)) continue;
    approaches_[before].add(ways_m_[each], -1);
    take(each, exit, way_m, journeys);
  }
}

}  // namespace throng
