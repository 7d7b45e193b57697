#include "bench/realism/contact_account.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/measures/contact_depths.h"
#include "analysis/measures/heads.h"
#include "analysis/measures/lasting_contacts.h"
#include "analysis/measures/part_group.h"
#include "bench/realism/hand_inside.h"

namespace throng::realism {
namespace {

/// Depths as often as `throng compare` looks.
constexpr double kSample_s = 0.1;
constexpr double kDensity_s = 1;

Histogram depth_histogram() { return {0, 0.0005, 1200}; }

int64_t frames_in(double seconds, double step_s) {
  return std::max<int64_t>(1, std::llround(seconds / step_s));
}

uint64_t people_key(PairKey pair) { return pair.bits() >> 16; }

}  // namespace

ContactTally::ContactTally() : depths(depth_histogram()), depths_of_most(depth_histogram()) {}

void ContactTally::add(const ContactTally& other) {
  contacts += other.contacts;
  trunks += other.trunks;
  hands_in += other.hands_in;
  hands_deep += other.hands_deep;
  depths.add(other.depths);
  depths_of_most.add(other.depths_of_most);
}

void ContactLevel::add(const ContactLevel& other) {
  person_s += other.person_s;
  touching_s += other.touching_s;
  for (size_t i = 0; i < apart.size(); ++i) apart[i].add(other.apart[i]);
}

ContactSums::ContactSums() : depths_of(kGroupPairs, depth_histogram()) {}

void ContactSums::add(const ContactSums& other) {
  person_s += other.person_s;
  for (size_t i = 0; i < kLevels; ++i) levels[i].add(other.levels[i]);
  for (size_t i = 0; i < depths_of.size(); ++i) depths_of[i].add(other.depths_of[i]);
  nearest_heads_m = std::min(nearest_heads_m, other.nearest_heads_m);
}

ContactLevel ContactSums::all() const {
  ContactLevel all;
  for (const ContactLevel& level : levels) all.add(level);
  // Levels of density are looked up once a second; who was there, at every frame.
  all.touching_s *= all.person_s > 0 ? person_s / all.person_s : 0;
  all.person_s = person_s;
  return all;
}

/// A contact that lasts.
struct ContactAccount::Met {
  size_t level = 0;
  double nearest_heads_m = std::numeric_limits<double>::infinity();
  bool trunks = false, hands_in = false, hands_deep = false;
};

struct ContactAccount::State {
  explicit State(const RunInfo& run)
      : people(run.model_of_avatar.size()),
        sample_every(frames_in(kSample_s, run.step_s)),
        density_every(frames_in(kDensity_s, run.step_s)),
        step_s(run.step_s),
        measures(run),
        groups(run),
        heads(run),
        depths(run),
        hands(run),
        heads_m(people),
        touches(people),
        open(ContactMeasures::kGap_s) {}

  double heads_apart_m(PairKey pair) const {
    return (heads_m[pair.a()] - heads_m[pair.b()]).norm();
  }
  size_t group_of(PairKey pair) const {
    return group_pair(groups.of(pair.a(), pair.part_a()), groups.of(pair.b(), pair.part_b()));
  }

  size_t people;
  int64_t sample_every, density_every;
  double step_s;
  ContactMeasures measures;  ///< knows levels of density
  PartGroups groups;
  Heads heads;
  ContactDepths depths;
  HandInside hands;
  std::vector<Eigen::Vector2d> heads_m;
  std::vector<uint8_t> touches;
  LastingContacts<Met> open;
};

ContactAccount::ContactAccount() = default;
ContactAccount::~ContactAccount() = default;

void ContactAccount::begin(const RunInfo& run) { state_ = std::make_unique<State>(run); }

void ContactAccount::add_up(const Met& met) {
  ContactLevel& level = sums_.levels[met.level];
  sums_.nearest_heads_m = std::min(sums_.nearest_heads_m, met.nearest_heads_m);
  for (size_t i = 0; i < kNearHeads_m.size(); ++i) {
    if (met.nearest_heads_m < kNearHeads_m[i]) continue;
    ++level.apart[i].contacts;
    level.apart[i].trunks += met.trunks;
    level.apart[i].hands_in += met.hands_in;
    level.apart[i].hands_deep += met.hands_deep;
  }
}

/// Contacts that begin, go on and end.
void ContactAccount::meet(const Frame& frame) {
  State& s = *state_;
  const double now_s = static_cast<double>(frame.number) * s.step_s;
  s.open.forget_ended(now_s, [&](const Met& met) { add_up(met); });
  for (const PairEvent& event : frame.events) {
    if (event.kind != EventKind::kBegin || event.pair.b() >= s.people) continue;
    if (s.open.begin(people_key(event.pair), now_s))
      s.open.find(people_key(event.pair))->level =
          s.measures.level_of(event.pair.a(), event.pair.b());
  }
  for (const PairEvent& event : frame.events)
    if (event.kind == EventKind::kEnd && event.pair.b() < s.people)
      s.open.finish(people_key(event.pair), now_s);
  static const size_t trunks = group_pair(PartGroup::kTrunk, PartGroup::kTrunk);
  for (const PairKey& pair : frame.pairs) {
    if (pair.b() >= s.people) continue;
    Met& met = *s.open.find(people_key(pair));
    met.nearest_heads_m = std::min(met.nearest_heads_m, s.heads_apart_m(pair));
    met.trunks |= s.group_of(pair) == trunks;
  }
}

void ContactAccount::sample(const RunInfo& run, const Frame& frame) {
  State& s = *state_;
  // Pairs come sorted: those of two people one after another.
  uint64_t people = 0;
  double most_m = -1, apart_m = 0;
  size_t level = 0;
  const auto close = [&] {
    for (size_t i = 0; i < kNearHeads_m.size() && most_m >= 0; ++i)
      if (apart_m >= kNearHeads_m[i]) sums_.levels[level].apart[i].depths_of_most.add(most_m);
  };
  s.depths.find(run, frame, [&](PairKey pair, double depth_m) {
    if (people_key(pair) != people || most_m < 0) {
      close();
      people = people_key(pair);
      most_m = 0;
      apart_m = s.heads_apart_m(pair);
      level = s.measures.level_of(pair.a(), pair.b());
    }
    most_m = std::max(most_m, depth_m);
    for (size_t i = 0; i < kNearHeads_m.size(); ++i)
      if (apart_m >= kNearHeads_m[i]) sums_.levels[level].apart[i].depths.add(depth_m);
    sums_.depths_of[s.group_of(pair)].add(depth_m);
    // What is inside would have to move by about as much as it is thick.
    const double thickness_m = s.hands.thickness_m(run, pair);
    if (depth_m < 0.5 * thickness_m) return;
    Met& met = *s.open.find(people);
    met.hands_deep |= depth_m >= thickness_m;
    met.hands_in = met.hands_in || s.hands.is_inside(run, frame, pair);
  });
  close();
}

void ContactAccount::spend_time(const Frame& frame) {
  State& s = *state_;
  const bool is_sampled = frame.number % s.density_every == 0;
  if (is_sampled) {
    std::fill(s.touches.begin(), s.touches.end(), 0);
    for (const PairKey& pair : frame.pairs)
      if (pair.b() < s.people) s.touches[pair.a()] = s.touches[pair.b()] = 1;
  }
  for (uint32_t id = 0; id < s.people; ++id) {
    if (!frame.present.empty() && frame.present[id] == 0) continue;
    sums_.person_s += s.step_s;
    if (!is_sampled) continue;
    const double stands_for_s = static_cast<double>(s.density_every) * s.step_s;
    ContactLevel& level = sums_.levels[s.measures.level_of(id, id)];
    level.person_s += stands_for_s;
    level.touching_s += s.touches[id] * stands_for_s;
  }
}

void ContactAccount::frame(const RunInfo& run, const Frame& frame) {
  State& s = *state_;
  s.measures.frame(frame);
  if (!frame.pairs.empty()) s.heads.find(run, frame, s.heads_m);
  meet(frame);
  if (frame.number % s.sample_every == 0) sample(run, frame);
  spend_time(frame);
}

void ContactAccount::end(const RunInfo&, const RunEnd&) {
  state_->open.forget_all([&](const Met& met) { add_up(met); });
}

}  // namespace throng::realism
