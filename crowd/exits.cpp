#include "crowd/exits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"

namespace throng {
namespace {

constexpr float kUnreachable_m = std::numeric_limits<float>::infinity();
/// Agents per batch; a block takes about ten microseconds.
constexpr size_t kMaxChoosers = 4096;
constexpr size_t kChoosersPerBlock = 64;
constexpr double kMaxFlow_per_s = 1e6;

}  // namespace

uint32_t DistanceHistogram::bin_of(float distance_m) {
  constexpr float kFine_m = 64;
  const float bin =
      distance_m < kFine_m ? 2 * distance_m : 2 * kFine_m + 0.25f * (distance_m - kFine_m);
  return static_cast<uint32_t>(std::clamp(bin, 0.0f, static_cast<float>(kBins - 1)));
}

void DistanceHistogram::add(float distance_m, int32_t people) {
  for (uint32_t at = bin_of(distance_m) + 1; at <= kBins; at += at & (~at + 1)) sums_[at] += people;
}

int32_t DistanceHistogram::below(uint32_t bin) const {
  int32_t sum = 0;
  for (uint32_t at = bin; at > 0; at &= at - 1) sum += sums_[at];
  return sum;
}

double DistanceHistogram::ahead_of(float distance_m) const {
  const uint32_t bin = bin_of(distance_m);
  return 0.5 * (below(bin) + below(bin + 1));
}

Exits::Exits(const NavigationMap& map, std::span<const AgentSpec> people, uint64_t seed)
    : map_(map), seed_(seed) {
  for (const Exit& exit : map.exits()) {
    State& state = states_.emplace_back();
    state.flow_per_s = std::max(tuning::kExitFlow_per_ms * exit.width_m, tuning::kMinFlow_per_s);
  }
  if (!has_any()) return;
  for (size_t group = 0; group < map.groups(); ++group)
    for (const Stop& stop : map.route(group)) max_exits_ = std::max<size_t>(max_exits_, stop.exits);
  histograms_.resize(states_.size());
  for (const AgentSpec& person : people)
    desired_speeds_mps_.push_back(static_cast<float>(person.desired_speed_mps));
  last_exits_.assign(people.size(), Journeys::kNoExit);
  distances_m_.assign(people.size(), 0);
  choosers_.reserve(people.size());
  exit_distances_m_.resize(std::min(people.size(), kMaxChoosers) * max_exits_);
}

void Exits::archive(Archive& a) {
  a(last_exits_, distances_m_, states_);
  if (!a.is_reading()) return;
  // Negated to reject NaN as well.
  for (const State& state : states_)
    if (!(state.flow_per_s >= tuning::kMinFlow_per_s && state.flow_per_s <= kMaxFlow_per_s))
      a.reject("a flow through an exit", "another value");
  for (const float distance_m : distances_m_)
    if (!(distance_m >= 0 && distance_m < kUnreachable_m))
      a.reject("a path length", "another value");
  for (const uint32_t exit : last_exits_)
    if (exit < Journeys::kOpen && exit >= states_.size())
      a.reject("an index of an exit", "another value");
}

void Exits::choose(uint64_t decision, std::span<const Eigen::Vector2d> positions_m,
                   std::span<const uint32_t> order, std::span<const uint8_t> queuing,
                   Journeys& journeys, Workers& workers) {
  count(journeys);
  const uint64_t phase = decision % tuning::kReconsiderPeriods;
  if (phase == 0) watch(journeys, order, queuing);
  choosers_.clear();
  for (uint32_t id = 0; id < last_exits_.size(); ++id) {
    const uint32_t exit = journeys.exit(id);
    const bool reconsiders = exit < Journeys::kOpen && id % tuning::kReconsiderPeriods == phase &&
                             journeys.first_member(id) == id;
    if (exit == Journeys::kOpen || reconsiders) choosers_.push_back(id);
  }
  for (size_t first = 0; first < choosers_.size(); first += kMaxChoosers) {
    const auto some =
        std::span(choosers_).subspan(first, std::min(kMaxChoosers, choosers_.size() - first));
    const auto blocks = static_cast<int>((some.size() + kChoosersPerBlock - 1) / kChoosersPerBlock);
    workers.for_blocks(blocks, [&](int block, int) {
      const size_t begin = static_cast<size_t>(block) * kChoosersPerBlock;
      for (size_t i = begin; i < std::min(begin + kChoosersPerBlock, some.size()); ++i) {
        const Stop& stop = journeys.stop(some[i]);
        for (uint32_t exit = 0; exit < stop.exits; ++exit)
          exit_distances_m_[i * max_exits_ + exit] = static_cast<float>(
              map_.exits()[stop.first_exit + exit].field->distance_m(positions_m[some[i]]));
      }
    });
    for (size_t i = 0; i < some.size(); ++i)
      choose_exit(some[i], std::span(exit_distances_m_).subspan(i * max_exits_, max_exits_),
                  positions_m, journeys);
  }
}

/// Counts agents by the exit they walk to; those that have left it since have arrived.
void Exits::count(const Journeys& journeys) {
  for (DistanceHistogram& histogram : histograms_) histogram.clear();
  for (uint32_t id = 0; id < last_exits_.size(); ++id) {
    const uint32_t exit = journeys.exit(id);
    if (last_exits_[id] < Journeys::kOpen && exit != last_exits_[id]) {
      ++states_[last_exits_[id]].arrived;
      states_[last_exits_[id]].has_flowed = true;
    }
    last_exits_[id] = exit;
    if (exit < Journeys::kOpen) histograms_[exit].add(distances_m_[id], 1);
  }
}

/// Updates the flow estimates once per second. Only an exit with a queue shows its capacity.
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
    const bool shows = state.has_flowed && state.queuing >= tuning::kMinQueuing;
    if (!shows && more <= 0) continue;
    const double known_s = tuning::kFlowPrior_s + state.observed_s;
    state.flow_per_s += more / std::min(known_s + 1, tuning::kFlowWindow_s);
    state.flow_per_s = std::max(state.flow_per_s, tuning::kMinFlow_per_s);
    if (shows) ++state.observed_s;
  }
}

/// Expected time until an agent is through, at least its walking time and that of nearer agents.
double Exits::expected_s(uint32_t exit, uint32_t id, float distance_m) const {
  const double walks_s =
      static_cast<double>(distance_m) / static_cast<double>(desired_speeds_mps_[id]);
  return std::max(walks_s, histograms_[exit].ahead_of(distance_m) / states_[exit].flow_per_s);
}

double Exits::patience_s(uint32_t id) const {
  return random_uniform({seed_, id, 0, Purpose::kPatience}, tuning::kMinPatience_s,
                        tuning::kMaxPatience_s);
}

void Exits::assign(uint32_t id, uint32_t exit, float distance_m, Journeys& journeys) {
  journeys.take_exit(id, exit);
  last_exits_[id] = exit;
  distances_m_[id] = distance_m;
  histograms_[exit].add(distance_m, 1);
}

/// An agent too close to a wall for the fields finds no path and keeps its exit.
void Exits::choose_exit(uint32_t id, std::span<const float> distances_m,
                        std::span<const Eigen::Vector2d> positions_m, Journeys& journeys) {
  const Stop& stop = journeys.stop(id);
  const uint32_t own = journeys.exit(id);
  const bool has_own = own < Journeys::kOpen;
  if (const uint32_t group_exit = has_own ? own : exit_of_group(id, journeys);
      group_exit != own && distances_m[group_exit - stop.first_exit] < kUnreachable_m)
    return assign(id, group_exit, distances_m[group_exit - stop.first_exit], journeys);
  if (has_own) {
    histograms_[own].add(distances_m_[id], -1);
    if (distances_m[own - stop.first_exit] < kUnreachable_m)
      distances_m_[id] = distances_m[own - stop.first_exit];
  }
  const double own_s = has_own ? expected_s(own, id, distances_m_[id]) : 0;
  uint32_t best = own;
  double best_s = std::numeric_limits<double>::infinity();
  if (has_own) best_s = (1 - tuning::kMinImprovement) * own_s - patience_s(id);
  for (uint32_t i = 0; i < stop.exits; ++i) {
    const uint32_t exit = stop.first_exit + i;
    if (exit == own || !(distances_m[i] < kUnreachable_m)) continue;
    const double expected = expected_s(exit, id, distances_m[i]);
    if (!(expected < best_s)) continue;
    best = exit;
    best_s = expected;
  }
  if (best == Journeys::kOpen) return;
  assign(id, best, best == own ? distances_m_[id] : distances_m[best - stop.first_exit], journeys);
  if (has_own) redirect_group(id, positions_m, journeys);
}

uint32_t Exits::exit_of_group(uint32_t id, const Journeys& journeys) const {
  const uint32_t first = journeys.first_member(id);
  for (uint32_t each = first; each < last_exits_.size() && journeys.first_member(each) == first;
       ++each)
    if (journeys.exit(each) < Journeys::kOpen && &journeys.stop(each) == &journeys.stop(id))
      return journeys.exit(each);
  return journeys.exit(id);
}

void Exits::redirect_group(uint32_t first, std::span<const Eigen::Vector2d> positions_m,
                           Journeys& journeys) {
  const uint32_t exit = journeys.exit(first);
  for (uint32_t each = first + 1; each < last_exits_.size() && journeys.first_member(each) == first;
       ++each) {
    const uint32_t before = journeys.exit(each);
    if (!(before < Journeys::kOpen) || before == exit) continue;
    if (&journeys.stop(each) != &journeys.stop(first)) continue;
    const auto distance_m =
        static_cast<float>(map_.exits()[exit].field->distance_m(positions_m[each]));
    if (!(distance_m < kUnreachable_m)) continue;
    histograms_[before].add(distances_m_[each], -1);
    assign(each, exit, distance_m, journeys);
  }
}

}  // namespace throng
