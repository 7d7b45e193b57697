#include "analysis/measures/contact_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
namespace {

constexpr double kDepthBin_m = 0.0005;
constexpr size_t kDepthBins = 1200;
constexpr double kAbsent = std::numeric_limits<double>::infinity();

Histogram depth_histogram() { return {0, kDepthBin_m, kDepthBins}; }

}  // namespace

ContactMeasures::ContactMeasures(const RunInfo& run, double gap_s, double settles_s)
    : step_s_(run.step_s),
      gap_s_(gap_s),
      settles_s_(settles_s),
      sample_every_(std::max<int64_t>(1, std::llround(1 / run.step_s))),
      people_(run.model_of_avatar.size()),
      groups_(run),
      density_(*run.scene),
      positions_m_(people_),
      densities_(people_, -1),
      came_s_(people_, kAbsent),
      open_(gap_s),
      open_groups_(gap_s),
      depths_(depth_histogram()),
      deepest_(depth_histogram()),
      depths_at_(kLevels, depth_histogram()),
      depths_of_(kGroupPairs, depth_histogram()) {}

/// Only frames in which somebody asks for a density.
void ContactMeasures::place(const Frame& frame) {
  if (is_placed_) return;
  is_placed_ = true;
  for (size_t id = 0; id < people_; ++id) positions_m_[id] = frame.roots[id].position_m.head<2>();
  density_.place(positions_m_, frame.present);
  std::fill(densities_.begin(), densities_.end(), -1);
}

double ContactMeasures::density_at(uint32_t person) {
  place(*frame_);
  if (densities_[person] < 0) densities_[person] = density_.around(positions_m_[person]);
  return densities_[person];
}

size_t ContactMeasures::level_of(uint32_t a, uint32_t b) {
  const double density = 0.5 * (density_at(a) + density_at(b));
  return static_cast<size_t>(
      std::upper_bound(kBounds_per_m2.begin(), kBounds_per_m2.end(), density) -
      kBounds_per_m2.begin());
}

uint64_t ContactMeasures::group_key(PairKey pair) const {
  return people_key(pair) << 8 |
         group_pair(groups_.of(pair.a(), pair.part_a()), groups_.of(pair.b(), pair.part_b()));
}

void ContactMeasures::add_deepest(const Deepest& deepest) {
  if (deepest.of_people_m >= 0) deepest_.add(deepest.of_people_m);
}

void ContactMeasures::note_newcomers(const Frame& frame) {
  for (uint32_t id = 0; id < people_; ++id) {
    const bool is_there = frame.present.empty() || frame.present[id] != 0;
    came_s_[id] = is_there ? std::min(came_s_[id], now_s_) : kAbsent;
  }
}

/// Each frame stands for the step that follows it.
void ContactMeasures::spend_time(const Frame& frame) {
  const bool is_sampled = frame.number % sample_every_ == 0;
  for (uint32_t id = 0; id < people_; ++id) {
    if (!is_settled(id)) continue;
    person_s_ += step_s_;
    if (is_sampled) person_s_at_[level_of(id, id)] += static_cast<double>(sample_every_) * step_s_;
  }
}

void ContactMeasures::frame(const Frame& frame) {
  now_s_ = static_cast<double>(frame.number) * step_s_;
  frame_ = &frame;
  is_placed_ = false;
  note_newcomers(frame);
  open_.forget_ended(now_s_, [&](const Deepest& deepest) { add_deepest(deepest); });
  open_groups_.forget_ended(now_s_, [](const Nothing&) {});
  for (const PairEvent& event : frame.events) {
    if (event.kind != EventKind::kBegin || event.pair.b() >= people_) continue;
    const bool counts = is_settled(event.pair.a()) && is_settled(event.pair.b());
    if (open_.begin(people_key(event.pair), now_s_) && counts)
      ++contacts_[level_of(event.pair.a(), event.pair.b())];
    const uint64_t key = group_key(event.pair);
    if (open_groups_.begin(key, now_s_) && counts) ++group_contacts_[key & 0xff];
  }
  for (const PairEvent& event : frame.events) {
    if (event.kind != EventKind::kEnd || event.pair.b() >= people_) continue;
    open_.finish(people_key(event.pair), now_s_);
    open_groups_.finish(group_key(event.pair), now_s_);
  }
  spend_time(frame);
}

void ContactMeasures::end() {
  open_.forget_all([&](const Deepest& deepest) { add_deepest(deepest); });
  open_groups_.forget_all([](const Nothing&) {});
}

void ContactMeasures::add_depth(PairKey pair, double depth_m) {
  depths_.add(depth_m);
  depths_at_[level_of(pair.a(), pair.b())].add(depth_m);
  depths_of_[group_key(pair) & 0xff].add(depth_m);
  if (Deepest* const deepest = open_.find(people_key(pair)))
    deepest->of_people_m = std::max(deepest->of_people_m, depth_m);
}

uint64_t ContactMeasures::contacts() const {
  uint64_t sum = 0;
  for (const uint64_t count : contacts_) sum += count;
  return sum;
}

namespace {

/// Both of a contact have it.
double per_person_min(uint64_t contacts, double person_s) {
  return person_s > 0 ? 2 * static_cast<double>(contacts) / person_s * 60
                      : std::numeric_limits<double>::quiet_NaN();
}

/// A row where a level of density is.
MeasureRow level_row(size_t level, std::string which, std::string what, std::string unit,
                     double value) {
  const auto& bounds = ContactMeasures::kBounds_per_m2;
  return ranged_row(level == 0 ? 0 : bounds[level - 1],
                    level < bounds.size() ? std::optional(bounds[level]) : std::nullopt,
                    std::move(which), std::move(what), std::move(unit), value);
}

}  // namespace

MeasureTable ContactMeasures::contact_table() const {
  MeasureTable table{"contacts",
                     "Contacts of two people",
                     "density",
                     "people per m2",
                     fmt::format("By triangles, a person and minute; two who part for less than "
                                 "{} s are still at the same contact. Density: people within 2 m. "
                                 "By part: of two groups of parts, of two people.",
                                 gap_s_),
                     {},
                     {}};
  const auto row = [&](std::string at, uint64_t contacts, double person_s) {
    table.rows.push_back(
        {std::move(at), {}, {}, "", "contacts", "1/min", per_person_min(contacts, person_s)});
  };
  row("all", contacts(), person_s_);
  for (size_t level = 0; level < kLevels; ++level)
    if (person_s_at_[level] > 0) {
      table.rows.push_back(level_row(level, "", "contacts", "1/min",
                                     per_person_min(contacts_[level], person_s_at_[level])));
      table.rows.push_back(level_row(level, "", "time", "person s", person_s_at_[level]));
    }
  for (size_t pair = 0; pair < kGroupPairs; ++pair)
    if (group_contacts_[pair] > 0) row(name_of_group_pair(pair), group_contacts_[pair], person_s_);
  return table;
}

namespace {

void add_depth_rows(const Histogram& depths, const MeasureRow& at, MeasureTable& table) {
  if (depths.count() == 0) return;
  const auto row = [&](const std::string& what, const std::string& unit, double value) {
    MeasureRow added = at;
    added.what = what;
    added.unit = unit;
    added.value = value;
    table.rows.push_back(added);
  };
  row("50 %", "m", depths.quantile(0.5));
  row("90 %", "m", depths.quantile(0.9));
  row("99 %", "m", depths.quantile(0.99));
  for (const int cm : {2, 5, 10})
    row(fmt::format("> {} cm", cm), "%", 100 * depths.share_above(0.01 * cm));
  row("most", "m", depths.max());
}

}  // namespace

MeasureTable ContactMeasures::depth_table() const {
  MeasureTable table{"depth",
                     "Depth of contacts",
                     "part",
                     "people per m2",
                     "How far two parts that touch would have to move apart, ten times a second: "
                     "the least translation that parts their convex hulls. Shares are of these "
                     "instants. Deepest: of a contact of two people, while it lasts.",
                     {},
                     {}};
  add_depth_rows(depths_, {.at = "all"}, table);
  add_depth_rows(deepest_, {.at = "deepest of a contact"}, table);
  for (size_t level = 0; level < kLevels; ++level)
    add_depth_rows(depths_at_[level], level_row(level, "", "", "", 0), table);
  for (size_t pair = 0; pair < kGroupPairs; ++pair)
    add_depth_rows(depths_of_[pair], {.at = name_of_group_pair(pair)}, table);
  MeasureCurve curve{"deeper than", {}};
  for (int mm = 0; mm <= 200 && depths_.count() > 0; mm += 2)
    curve.points.emplace_back(0.1 * mm, 100 * depths_.share_above(0.001 * mm));
  table.curves.push_back(curve);
  return table;
}

}  // namespace throng
