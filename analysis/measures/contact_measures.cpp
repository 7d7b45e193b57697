#include "analysis/measures/contact_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/run/sink.h"

namespace throng {
namespace {

constexpr size_t kNoPose = SIZE_MAX;

}  // namespace

ContactDepths::ContactDepths(const RunInfo& run)
    : first_pose_(run.model_of_avatar.size(), kNoPose) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<ConvexHull>& hulls = hulls_.emplace_back();
    for (const Part& part : model->parts) hulls.emplace_back(part.mesh.vertices);
  }
}

const PartPose* ContactDepths::poses_of(const RunInfo& run, const Frame& frame, uint32_t avatar) {
  if (first_pose_[avatar] == kNoPose) {
    const Model& model = *run.models[run.model_of_avatar[avatar]];
    first_pose_[avatar] = poses_.size();
    poses_.resize(poses_.size() + model.parts.size());
    part_poses(run, frame, avatar, std::span(poses_).subspan(first_pose_[avatar]));
  }
  return poses_.data() + first_pose_[avatar];
}

void ContactDepths::find(const RunInfo& run, const Frame& frame,
                         const std::function<void(PairKey, double)>& found) {
  std::fill(first_pose_.begin(), first_pose_.end(), kNoPose);
  poses_.clear();
  for (const PairKey& pair : frame.pairs) {
    if (pair.b() >= first_pose_.size() || pair.part_a() == kWholeBody) continue;
    poses_of(run, frame, pair.a());  // first, because this may reallocate poses_
    const PartPose* of_b = poses_of(run, frame, pair.b()) + pair.part_b();
    const PartPose* of_a = poses_of(run, frame, pair.a()) + pair.part_a();
    const ConvexHull& hull_a = hulls_[run.model_of_avatar[pair.a()]][pair.part_a()];
    const ConvexHull& hull_b = hulls_[run.model_of_avatar[pair.b()]][pair.part_b()];
    const Eigen::Vector3f shift =
        (frame.roots[pair.b()].position_m - frame.roots[pair.a()].position_m).cast<float>();
    found(pair, finder_
                    .depth({&hull_a, of_a, run.scale_of_avatar[pair.a()]},
                           {&hull_b, of_b, run.scale_of_avatar[pair.b()]}, shift)
                    .depth_m);
  }
}

namespace {

constexpr double kDepthBin_m = 0.0005;
constexpr size_t kDepthBins = 1200;
constexpr double kAbsent = std::numeric_limits<double>::infinity();

}  // namespace

Histogram depth_histogram() { return {0, kDepthBin_m, kDepthBins}; }

ContactMeasures::ContactMeasures(const RunInfo& run, double gap_s, double settles_s)
    : step_s_(run.step_s),
      gap_s_(gap_s),
      settles_s_(settles_s),
      sample_every_(frames_in(1, run.step_s)),
      people_(run.model_of_avatar.size()),
      groups_(run),
      density_(run),
      entered_s_(people_, kAbsent),
      open_(gap_s),
      open_groups_(gap_s),
      depths_(depth_histogram()),
      max_depths_(depth_histogram()),
      depths_at_(kLevels, depth_histogram()),
      depths_of_(kGroupPairs, depth_histogram()) {}

size_t ContactMeasures::level_at(double density_per_m2) {
  return static_cast<size_t>(
      std::upper_bound(kBounds_per_m2.begin(), kBounds_per_m2.end(), density_per_m2) -
      kBounds_per_m2.begin());
}

uint64_t ContactMeasures::group_key(PairKey pair) const {
  return people_of(pair) << 8 |
         group_pair(groups_.of(pair.a(), pair.part_a()), groups_.of(pair.b(), pair.part_b()));
}

void ContactMeasures::add_max_depth(const MaxDepth& max_depth) {
  if (max_depth.depth_m >= 0) max_depths_.add(max_depth.depth_m);
}

void ContactMeasures::note_entries(const Frame& frame) {
  for (uint32_t id = 0; id < people_; ++id) {
    const bool is_there = frame.present.empty() || frame.present[id] != 0;
    entered_s_[id] = is_there ? std::min(entered_s_[id], now_s_) : kAbsent;
  }
}

/// Each frame represents the step that follows it.
void ContactMeasures::accumulate_time(const Frame& frame) {
  const bool is_sampled = frame.number % sample_every_ == 0;
  for (uint32_t id = 0; id < people_; ++id) {
    if (!is_settled(id)) continue;
    person_s_ += step_s_;
    if (is_sampled) person_s_at_[level_of(id, id)] += static_cast<double>(sample_every_) * step_s_;
  }
}

void ContactMeasures::frame(const Frame& frame) {
  now_s_ = static_cast<double>(frame.number) * step_s_;
  density_.frame(frame);
  note_entries(frame);
  events_.clear();
  for (const PairEvent& event : frame.events)
    if (event.pair.b() < people_) events_.push_back(event);
  const auto counts = [&](PairKey pair) { return is_settled(pair.a()) && is_settled(pair.b()); };
  open_.take(
      events_, now_s_, people_of,
      [&](PairKey pair, const MaxDepth&, bool begins) {
        if (begins && counts(pair)) ++contacts_[level_of(pair.a(), pair.b())];
      },
      [&](const MaxDepth& max_depth) { add_max_depth(max_depth); });
  open_groups_.take(
      events_, now_s_, [&](PairKey pair) { return group_key(pair); },
      [&](PairKey pair, const NoData&, bool begins) {
        if (begins && counts(pair)) ++group_contacts_[group_key(pair) & 0xff];
      },
      [](const NoData&) {});
  accumulate_time(frame);
}

void ContactMeasures::end() {
  open_.forget_all([&](const MaxDepth& max_depth) { add_max_depth(max_depth); });
  open_groups_.forget_all([](const NoData&) {});
}

void ContactMeasures::add_depth(PairKey pair, double depth_m) {
  depths_.add(depth_m);
  depths_at_[level_of(pair.a(), pair.b())].add(depth_m);
  depths_of_[group_key(pair) & 0xff].add(depth_m);
  if (MaxDepth* const max_depth = open_.find(people_of(pair)))
    max_depth->depth_m = std::max(max_depth->depth_m, depth_m);
}

uint64_t ContactMeasures::contacts() const {
  uint64_t sum = 0;
  for (const uint64_t count : contacts_) sum += count;
  return sum;
}

namespace {

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
                     fmt::format("Per person and minute, by triangles; a contact that begins "
                                 "again within "
                                 "{} s continues. Density: people within 2 m. "
                                 "By part: contacts of two groups of parts of two people.",
                                 gap_s_),
                     {},
                     {}};
  const auto row = [&](std::string at, uint64_t contacts, double person_s) {
    table.rows.push_back({std::move(at),
                          {},
                          {},
                          "",
                          "contacts",
                          "1/min",
                          contacts_per_person_min(contacts, person_s)});
  };
  row("all", contacts(), person_s_);
  for (size_t level = 0; level < kLevels; ++level)
    if (person_s_at_[level] > 0) {
      table.rows.push_back(
          level_row(level, "", "contacts", "1/min",
                    contacts_per_person_min(contacts_[level], person_s_at_[level])));
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
  row("max", "m", depths.max());
}

}  // namespace

MeasureTable ContactMeasures::depth_table() const {
  MeasureTable table{"depth",
                     "Depth of contacts",
                     "part",
                     "people per m2",
                     "Penetration depth of two touching parts, sampled 10 times per second: "
                     "least translation that separates their convex hulls. Shares refer to the "
                     "samples. Maximum per contact: over the duration of a contact of two people.",
                     {},
                     {}};
  add_depth_rows(depths_, {.at = "all"}, table);
  add_depth_rows(max_depths_, {.at = "maximum per contact"}, table);
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
