#include "bench/realism/contact_audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "analysis/measures/recent_crowd.h"
#include "analysis/part_names.h"
#include "culling/distance/hull_depth.h"
#include "scenes/run/sink.h"

namespace throng::realism {

HandPenetration::HandPenetration(const RunInfo& run) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<Solid>& solids = solids_.emplace_back();
    for (const Part& part : model->parts) {
      Solid& solid = solids.emplace_back();
      if (!part.mesh.triangles.empty())
        solid.surface = std::make_unique<TriangleBvh>(part.mesh.vertices, part.mesh.triangles);
      solid.is_hand = part_group(part.name) == PartGroup::kHand;
      if (!solid.is_hand) continue;
      Eigen::AlignedBox3f box;
      for (const Eigen::Vector3f& vertex : part.mesh.vertices) box.extend(vertex);
      solid.thickness_m = box.sizes().minCoeff();
      const ConvexHull hull(part.mesh.vertices);
      for (Eigen::Index i = 0; i < hull.points().rows(); ++i)
        solid.corners.emplace_back(hull.points().row(i).transpose().cast<float>());
    }
  }
}

const HandPenetration::Solid& HandPenetration::solid(const RunInfo& run, uint32_t avatar,
                                                     uint32_t part) const {
  return solids_[run.model_of_avatar[avatar]][part];
}

double HandPenetration::thickness_m(const RunInfo& run, PairKey pair) const {
  double min_m = std::numeric_limits<double>::infinity();
  for (const auto& [avatar, part] :
       {std::pair(pair.a(), pair.part_a()), std::pair(pair.b(), pair.part_b())})
    if (const Solid& one = solid(run, avatar, part); one.is_hand)
      min_m = std::min(min_m, static_cast<double>(one.thickness_m * run.scale_of_avatar[avatar]));
  return min_m;
}

HandPenetration::Placed HandPenetration::placed(const RunInfo& run, const Frame& frame,
                                                uint32_t avatar, uint32_t part,
                                                const Eigen::Vector3d& origin_m) {
  const Model& model = *run.models[run.model_of_avatar[avatar]];
  poses_.resize(model.parts.size());
  part_poses(run, frame, avatar, poses_);
  Eigen::Isometry3d world_from_part = to_isometry(poses_[part]);
  world_from_part.pretranslate(frame.roots[avatar].position_m - origin_m);
  return {&solid(run, avatar, part), world_from_part,
          static_cast<double>(run.scale_of_avatar[avatar])};
}

bool HandPenetration::contains(const Placed& outer, const Placed& hand) {
  if (!hand.solid->is_hand || outer.solid->surface == nullptr) return false;
  const Eigen::Isometry3d outer_from_hand = outer.world_from_part.inverse() * hand.world_from_part;
  return std::all_of(
      hand.solid->corners.begin(), hand.solid->corners.end(), [&](const Eigen::Vector3f& corner) {
        return outer.solid->surface->contains(outer_from_hand *
                                              (hand.scale * corner.cast<double>()) / outer.scale);
      });
}

bool HandPenetration::is_inside(const RunInfo& run, const Frame& frame, PairKey pair) {
  if (!solid(run, pair.a(), pair.part_a()).is_hand && !solid(run, pair.b(), pair.part_b()).is_hand)
    return false;
  const Eigen::Vector3d& origin_m = frame.roots[pair.a()].position_m;
  const Placed a = placed(run, frame, pair.a(), pair.part_a(), origin_m);
  const Placed b = placed(run, frame, pair.b(), pair.part_b(), origin_m);
  return contains(a, b) || contains(b, a);
}

namespace {

/// Depths are sampled as often as in `throng compare`.
constexpr double kSample_s = 0.1;
constexpr double kDensity_s = 1;

}  // namespace

ContactTally::ContactTally() : depths(depth_histogram()), max_depths(depth_histogram()) {}

void ContactTally::add(const ContactTally& other) {
  contacts += other.contacts;
  trunks += other.trunks;
  hands_in += other.hands_in;
  hands_deep += other.hands_deep;
  depths.add(other.depths);
  max_depths.add(other.max_depths);
}

void ContactLevel::add(const ContactLevel& other) {
  person_s += other.person_s;
  touching_s += other.touching_s;
  for (size_t i = 0; i < tallies.size(); ++i) tallies[i].add(other.tallies[i]);
}

ContactSums::ContactSums() : depths_of(kGroupPairs, depth_histogram()) {}

void ContactSums::add(const ContactSums& other) {
  person_s += other.person_s;
  for (size_t i = 0; i < kLevels; ++i) levels[i].add(other.levels[i]);
  for (size_t i = 0; i < depths_of.size(); ++i) depths_of[i].add(other.depths_of[i]);
  min_head_distance_m = std::min(min_head_distance_m, other.min_head_distance_m);
}

ContactLevel ContactSums::all() const {
  ContactLevel all;
  for (const ContactLevel& level : levels) all.add(level);
  // Density levels are sampled once per second, presence in every frame.
  all.touching_s *= all.person_s > 0 ? person_s / all.person_s : 0;
  all.person_s = person_s;
  return all;
}

struct ContactAudit::PairContact {
  size_t level = 0;
  double min_head_distance_m = std::numeric_limits<double>::infinity();
  bool trunks = false, hands_in = false, hands_deep = false;
};

struct ContactAudit::State {
  explicit State(const RunInfo& run)
      : people(run.model_of_avatar.size()),
        sample_every(frames_in(kSample_s, run.step_s)),
        density_every(frames_in(kDensity_s, run.step_s)),
        step_s(run.step_s),
        density(run),
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

  size_t level_of(uint32_t a, uint32_t b) {
    return ContactMeasures::level_at(density.between(a, b));
  }

  size_t people;
  int64_t sample_every, density_every;
  double step_s;
  CrowdDensity density;
  PartGroups groups;
  Heads heads;
  ContactDepths depths;
  HandPenetration hands;
  std::vector<Eigen::Vector2d> heads_m;
  std::vector<uint8_t> touches;
  std::vector<PairEvent> events;  ///< events of two people in a frame
  ContactTracker<PairContact> open;
};

ContactAudit::ContactAudit() = default;
ContactAudit::~ContactAudit() = default;

void ContactAudit::begin(const RunInfo& run) { state_ = std::make_unique<State>(run); }

void ContactAudit::accumulate(const PairContact& met) {
  ContactLevel& level = sums_.levels[met.level];
  sums_.min_head_distance_m = std::min(sums_.min_head_distance_m, met.min_head_distance_m);
  for (size_t i = 0; i < kMinHeadDistances_m.size(); ++i) {
    if (met.min_head_distance_m < kMinHeadDistances_m[i]) continue;
    ++level.tallies[i].contacts;
    level.tallies[i].trunks += met.trunks;
    level.tallies[i].hands_in += met.hands_in;
    level.tallies[i].hands_deep += met.hands_deep;
  }
}

void ContactAudit::track_contacts(const Frame& frame) {
  State& s = *state_;
  const double now_s = static_cast<double>(frame.number) * s.step_s;
  s.events.clear();
  for (const PairEvent& event : frame.events)
    if (event.pair.b() < s.people) s.events.push_back(event);
  s.open.take(
      s.events, now_s, people_of,
      [&](PairKey pair, PairContact& met, bool begins) {
        if (begins) met.level = s.level_of(pair.a(), pair.b());
      },
      [&](const PairContact& met) { accumulate(met); });
  static const size_t trunks = group_pair(PartGroup::kTrunk, PartGroup::kTrunk);
  for (const PairKey& pair : frame.pairs) {
    if (pair.b() >= s.people) continue;
    PairContact& met = *s.open.find(people_of(pair));
    met.min_head_distance_m = std::min(met.min_head_distance_m, s.heads_apart_m(pair));
    met.trunks |= s.group_of(pair) == trunks;
  }
}

void ContactAudit::sample(const RunInfo& run, const Frame& frame) {
  State& s = *state_;
  // Pairs are sorted: those of two people are adjacent.
  uint64_t people = 0;
  double max_m = -1, apart_m = 0;
  size_t level = 0;
  const auto close = [&] {
    for (size_t i = 0; i < kMinHeadDistances_m.size() && max_m >= 0; ++i)
      if (apart_m >= kMinHeadDistances_m[i]) sums_.levels[level].tallies[i].max_depths.add(max_m);
  };
  s.depths.find(run, frame, [&](PairKey pair, double depth_m) {
    if (people_of(pair) != people || max_m < 0) {
      close();
      people = people_of(pair);
      max_m = 0;
      apart_m = s.heads_apart_m(pair);
      level = s.level_of(pair.a(), pair.b());
    }
    max_m = std::max(max_m, depth_m);
    for (size_t i = 0; i < kMinHeadDistances_m.size(); ++i)
      if (apart_m >= kMinHeadDistances_m[i]) sums_.levels[level].tallies[i].depths.add(depth_m);
    sums_.depths_of[s.group_of(pair)].add(depth_m);
    // A hand inside would have to move by about its own thickness.
    const double thickness_m = s.hands.thickness_m(run, pair);
    if (depth_m < 0.5 * thickness_m) return;
    PairContact& met = *s.open.find(people);
    met.hands_deep |= depth_m >= thickness_m;
    met.hands_in = met.hands_in || s.hands.is_inside(run, frame, pair);
  });
  close();
}

void ContactAudit::accumulate_time(const Frame& frame) {
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
    ContactLevel& level = sums_.levels[s.level_of(id, id)];
    level.person_s += stands_for_s;
    level.touching_s += s.touches[id] * stands_for_s;
  }
}

void ContactAudit::frame(const RunInfo& run, const Frame& frame) {
  State& s = *state_;
  s.density.frame(frame);
  if (!frame.pairs.empty()) s.heads.find(run, frame, s.heads_m);
  track_contacts(frame);
  if (frame.number % s.sample_every == 0) sample(run, frame);
  accumulate_time(frame);
}

void ContactAudit::end(const RunInfo&, const RunEnd&) {
  state_->open.forget_all([&](const PairContact& met) { accumulate(met); });
}

namespace {

std::string number(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

/// A column of a table: its value for a level and for the tally of a minimum head distance.
struct Column {
  std::string name;
  int digits;
  std::function<double(const ContactLevel&, const ContactTally&)> value;
};

Column depth_column(const std::string& name, double share) {
  return {name, 1, [share](const ContactLevel&, const ContactTally& tally) {
            return 100 * tally.depths.quantile(share);
          }};
}

Column rate_column(const std::string& name, uint64_t ContactTally::*count, int digits) {
  return {name, digits, [count](const ContactLevel& level, const ContactTally& tally) {
            return contacts_per_person_min(tally.*count, level.person_s);
          }};
}

const std::vector<Column>& columns() {
  static const std::vector<Column> all = {
      rate_column("contacts", &ContactTally::contacts, 2),
      depth_column("50 %", 0.5),
      depth_column("90 %", 0.9),
      depth_column("99 %", 0.99),
      depth_column("max", 1),
      rate_column("trunks", &ContactTally::trunks, 3),
      rate_column("hand in", &ContactTally::hands_in, 3),
      rate_column("deep", &ContactTally::hands_deep, 3),
      {"touch %", 0, [](const ContactLevel& level, const ContactTally& tally) {
         // For all contacts only: neighbour distances are not stored.
         return &tally == level.tallies.data() && level.person_s > 0
                    ? 100 * level.touching_s / level.person_s
                    : std::numeric_limits<double>::quiet_NaN();
       }}};
  return all;
}

std::string cell(const std::string& before, const std::string* after) {
  return after == nullptr ? fmt::format("{:>9}", before)
                          : fmt::format("{:>8} >{:>7}", before, *after);
}

std::string level_line(const std::string& name, const ContactLevel& before,
                       const ContactLevel* after, size_t distance_index) {
  if (!(before.person_s > 0) && (after == nullptr || !(after->person_s > 0))) return "";
  const std::string after_s = after == nullptr ? "" : number(after->person_s, 0);
  std::string line = fmt::format(
      "  {:<13}{}", name, cell(number(before.person_s, 0), after == nullptr ? nullptr : &after_s));
  for (const Column& column : columns()) {
    const std::string after_text =
        after == nullptr
            ? ""
            : number(column.value(*after, after->tallies[distance_index]), column.digits);
    line += cell(number(column.value(before, before.tallies[distance_index]), column.digits),
                 after == nullptr ? nullptr : &after_text);
  }
  return line + "\n";
}

std::string block(const ContactSums& before, const ContactSums* after, size_t distance_index) {
  const bool is_pair = after != nullptr;
  std::string text = fmt::format("  {:<13}{:>{}}", "per m2", "person s", is_pair ? 17 : 9);
  for (const Column& column : columns())
    text += fmt::format("{:>{}}", column.name, is_pair ? 17 : 9);
  text += "\n";
  const auto& bounds = ContactMeasures::kBounds_per_m2;
  for (size_t i = 0; i < ContactSums::kLevels; ++i)
    text += level_line(range_text(i == 0 ? 0 : bounds[i - 1],
                                  i < bounds.size() ? std::optional(bounds[i]) : std::nullopt),
                       before.levels[i], is_pair ? &after->levels[i] : nullptr, distance_index);
  const ContactLevel all_before = before.all();
  const ContactLevel all_after = is_pair ? after->all() : ContactLevel();
  return text + level_line("all", all_before, is_pair ? &all_after : nullptr, distance_index);
}

/// Describes the contacts of people whose heads were closer than bodies allow.
std::string head_distance_line(const std::string& name, const ContactSums& sums) {
  const ContactLevel all = sums.all();
  std::string text = fmt::format("  {}: minimum head distance of touching people {} m;", name,
                                 number(sums.min_head_distance_m, 2));
  for (size_t i = 1; i < kMinHeadDistances_m.size(); ++i)
    text += fmt::format(" {} of {} contacts with heads closer than {:.2f} m{}",
                        all.tallies[0].contacts - all.tallies[i].contacts, all.tallies[0].contacts,
                        kMinHeadDistances_m[i], i + 1 < kMinHeadDistances_m.size() ? "," : "\n");
  return text;
}

std::string part_lines(const ContactSums& before, const ContactSums* after) {
  std::string text =
      fmt::format("\n  {:<18}{}{}{}\n", "parts, all levels", "  depth samples, 90 %, max (cm)",
                  after == nullptr ? "" : "; then after", "");
  const auto half = [](const Histogram& depths) {
    return fmt::format("{:>9}{:>7}{:>7}", depths.count(), number(100 * depths.quantile(0.9), 1),
                       number(100 * depths.max(), 1));
  };
  for (size_t group = 0; group < kGroupPairs; ++group) {
    if (before.depths_of[group].count() == 0 &&
        (after == nullptr || after->depths_of[group].count() == 0))
      continue;
    text += fmt::format("  {:<18}{}{}\n", name_of_group_pair(group), half(before.depths_of[group]),
                        after == nullptr ? "" : "  >" + half(after->depths_of[group]));
  }
  return text;
}

}  // namespace

std::string contact_report(const NamedContactSums& before, const NamedContactSums* after,
                           bool with_parts) {
  const ContactSums* const after_sums = after == nullptr ? nullptr : &after->sums;
  std::string text =
      fmt::format("{}{}\n", before.name, after == nullptr ? "" : fmt::format(" > {}", after->name));
  text +=
      "  per person and minute: contacts; those with trunk in trunk, with a hand wholly in another "
      "part, with a hand deeper than its thickness; depth of two parts in cm; % of time in "
      "contact\n";
  text += block(before.sums, after_sums, 0);
  for (size_t i = 1; i < kMinHeadDistances_m.size(); ++i)
    text += fmt::format("  without contacts whose heads came closer than {:.2f} m\n{}",
                        kMinHeadDistances_m[i], block(before.sums, after_sums, i));
  text += head_distance_line(before.name, before.sums);
  if (after != nullptr) text += head_distance_line(after->name, *after_sums);
  return with_parts ? text + part_lines(before.sums, after_sums) : text;
}

}  // namespace throng::realism
