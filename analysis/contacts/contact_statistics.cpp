#include "analysis/contacts/contact_statistics.h"

#include <algorithm>
#include <cmath>

namespace throng {

ContactStatistics::ContactStatistics(const RunInfo& run)
    : step_s_(run.step_s),
      sample_every_(frames_in(1, run.step_s)),
      density_(run),
      model_of_avatar_(run.model_of_avatar) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<uint32_t>& indices = name_of_part_.emplace_back();
    for (const Part& part : model->parts) {
      const auto known = std::find(names_.begin(), names_.end(), part.name);
      indices.push_back(static_cast<uint32_t>(known - names_.begin()));
      if (known == names_.end()) names_.push_back(part.name);
    }
  }
  whole_body_ = static_cast<uint32_t>(names_.size());
  names_.push_back("whole body");
  people_.resize(model_of_avatar_.size());
  touching_.assign(people_.size(), 0);
  part_counts_.assign(names_.size() * names_.size(), 0);
  part_seconds_.assign(names_.size() * names_.size(), 0);
  obstacle_part_counts_.assign(names_.size(), 0);
}

uint32_t ContactStatistics::name_index(uint32_t id, uint32_t part) const {
  return part == kWholeBody ? whole_body_ : name_of_part_[model_of_avatar_[id]][part];
}

std::string ContactStatistics::part_name(uint32_t id, uint32_t part) const {
  return names_[name_index(id, part)];
}

void ContactStatistics::begin(PairKey pair) {
  const uint32_t a = pair.a();
  const uint32_t b = pair.b();
  const uint32_t row = name_index(a, pair.part_a());
  if (!is_person(b)) {
    ++obstacle_part_counts_[row];
    NoData* nothing = nullptr;
    if (!open_obstacles_.begin(people_of(pair), nothing)) return;
    ++people_[a].obstacle_contacts;
    ++obstacle_contacts_;
    return;
  }
  const uint32_t column = name_index(b, pair.part_b());
  ++part_counts_[row * names_.size() + column];
  if (row != column) ++part_counts_[column * names_.size() + row];
  Contact* contact = nullptr;
  const bool begins = open_.begin(people_of(pair), contact);
  ++contact->part_contacts;
  if (!begins) return;
  const double density = density_.between(a, b);
  *contact = {a,
              b,
              static_cast<double>(frame_) * step_s_,
              0,
              0.5 * (position_m(a) + position_m(b)),
              density,
              pair.part_a(),
              pair.part_b(),
              1,
              is_first_};
  for (const uint32_t id : {a, b}) {
    ++people_[id].contacts;
    ++touching_[id];
  }
  contact_pairs_.add(people_of(pair));
  ++contacts_;
  ++minutes_.back().contacts;
  ++densities_[DensityLevels::level_of(density)].contacts;
}

void ContactStatistics::add_part_time(PairKey pair, double duration_s) {
  const uint32_t row = name_index(pair.a(), pair.part_a());
  const uint32_t column = name_index(pair.b(), pair.part_b());
  part_seconds_[row * names_.size() + column] += duration_s;
  if (row != column) part_seconds_[column * names_.size() + row] += duration_s;
}

void ContactStatistics::finish(PartContact part, bool is_truncated) {
  const double now_s = static_cast<double>(frame_) * step_s_;
  const uint64_t people = people_of(part.pair);
  if (!is_person(part.pair.b())) return open_obstacles_.finish(people, now_s, [](NoData) {});
  part.frames = frame_ - part.begin_frame;
  part.is_truncated = part.is_truncated || is_truncated;
  add_part_time(part.pair, static_cast<double>(part.frames) * step_s_);
  part_contacts_.add(part);
  open_.finish(people, now_s, [&](const Contact& contact) { finish(contact, is_truncated); });
}

void ContactStatistics::finish(Contact contact, bool is_truncated) {
  for (const uint32_t id : {contact.a, contact.b}) --touching_[id];
  contact.duration_s = static_cast<double>(frame_) * step_s_ - contact.begin_s;
  contact.is_truncated = contact.is_truncated || is_truncated;
  if (contact.is_truncated)
    ++truncated_;
  else
    add_length(contact.duration_s);
  ended_.push_back(contact);
}

void ContactStatistics::take(std::span<const PairEvent> events, bool ends_the_run) {
  open_parts_.take(
      events, static_cast<double>(frame_) * step_s_, [](PairKey pair) { return pair.bits(); },
      [&](PairKey pair, PartContact& part, bool) {
        part = {frame_, pair, 0, is_first_};
        begin(pair);
      },
      [&](const PartContact& part) { finish(part, ends_the_run); });
}

void ContactStatistics::add_length(double duration_s) {
  const auto frames = static_cast<size_t>(std::llround(duration_s / step_s_));
  if (frames >= lengths_.size()) lengths_.resize(frames + 1, 0);
  ++lengths_[frames];
  ++complete_;
}

/// Each frame stands for the step that follows it.
void ContactStatistics::accumulate_time(const Frame& frame) {
  const auto is_here = [&](size_t id) { return frame.present.empty() || frame.present[id] != 0; };
  MinuteRow& minute = minutes_.back();
  for (size_t id = 0; id < people_.size(); ++id) {
    if (!is_here(id)) continue;
    people_[id].present_s += step_s_;
    minute.person_s += step_s_;
    if (touching_[id] > 0) people_[id].touching_s += step_s_;
  }
  if (frame.number % sample_every_ != 0) return;
  for (uint32_t id = 0; id < people_.size(); ++id)
    if (is_here(id))
      densities_[DensityLevels::level_of(density_.at(id))].person_s +=
          static_cast<double>(sample_every_) * step_s_;
}

void ContactStatistics::frame(const Frame& frame) {
  frame_ = frame.number;
  ended_.clear();
  const auto minute = static_cast<size_t>(static_cast<double>(frame_) * step_s_ / 60);
  if (minutes_.size() <= minute) minutes_.resize(minute + 1);
  roots_ = frame.roots;
  density_.frame(frame);
  take(frame.events, false);
  accumulate_time(frame);
  is_first_ = false;
}

void ContactStatistics::count_partners() {
  uint64_t last = 0;  // no pair has this key
  contact_pairs_.for_each([&](uint64_t key) {
    if (key == last) return;
    last = key;
    for (const uint64_t id : {key >> 32, key & UINT32_MAX}) ++people_[id].partners;
  });
}

void ContactStatistics::end(const RunEnd& end) {
  ended_.clear();
  ++frame_;
  take(end.events, true);
  count_partners();
}

ContactTotals ContactStatistics::totals() const {
  ContactTotals totals;
  totals.contacts = contacts_;
  totals.obstacle_contacts = obstacle_contacts_;
  for (const PersonContacts& person : people_) {
    totals.people_touched += person.contacts > 0;
    totals.person_s += person.present_s;
    totals.touching_s += person.touching_s;
  }
  uint64_t shorter = 0;  // number of contacts up to this length
  for (size_t frames = 0; frames < lengths_.size() && 2 * shorter < complete_; ++frames) {
    shorter += lengths_[frames];
    totals.median_s = static_cast<double>(frames) * step_s_;
  }
  return totals;
}

PartMatrix ContactStatistics::parts() const {
  const size_t all = names_.size();
  const bool has_whole = obstacle_part_counts_[whole_body_] > 0 ||
                         std::any_of(part_counts_.end() - static_cast<ptrdiff_t>(all),
                                     part_counts_.end(), [](uint64_t count) { return count > 0; });
  const size_t shown = has_whole ? all : all - 1;
  PartMatrix matrix;
  for (size_t row = 0; row < shown; ++row) {
    matrix.names.push_back(names_[row]);
    matrix.obstacle_counts.push_back(obstacle_part_counts_[row]);
    for (size_t column = 0; column < shown; ++column) {
      matrix.counts.push_back(part_counts_[row * all + column]);
      matrix.seconds.push_back(part_seconds_[row * all + column]);
    }
  }
  return matrix;
}

}  // namespace throng
