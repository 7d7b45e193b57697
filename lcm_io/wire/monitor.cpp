#include "lcm_io/wire/monitor.h"

#include <algorithm>
#include <iterator>

namespace throng {
namespace {

constexpr double kHistoryStep_s = 0.25;
constexpr size_t kObstacle = 0, kWhole = 1;

Monitor::Totals difference(const Monitor::Totals& to, const Monitor::Totals& from) {
  Monitor::Totals out = to;
  const auto subtract = [](auto& a, const auto& b) {
    for (size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  };
  out.now_s -= from.now_s;
  out.frames -= from.frames;
  subtract(out.messages, from.messages);
  subtract(out.bytes, from.bytes);
  subtract(out.updates, from.updates);
  subtract(out.tests, from.tests);
  subtract(out.passed, from.passed);
  subtract(out.update_ns, from.update_ns);
  subtract(out.test_ns, from.test_ns);
  out.other_ns -= from.other_ns;
  out.begins -= from.begins;
  out.ends -= from.ends;
  return out;
}

}  // namespace

Monitor::Totals Monitor::now(double now_s) const {
  Totals totals = sums_;
  totals.now_s = now_s;
  for (const Channel channel : kAllChannels) {
    const auto i = static_cast<size_t>(channel);
    totals.messages[i] = inbox_.run().tally(channel).messages;
    totals.bytes[i] = inbox_.run().tally(channel).bytes;
  }
  return totals;
}

Monitor::Totals Monitor::overall(double now_s) const { return difference(now(now_s), first_); }

Monitor::Totals Monitor::recent(double now_s) const {
  return difference(now(now_s), history_.empty() ? first_ : history_.front());
}

void Monitor::begin_run(double now_s) {
  has_run_ = true;
  run_id_ = inbox_.run().run_id();
  instance_ = inbox_.run().instance();
  sums_ = {};
  first_ = {};
  first_.now_s = now_s;  // including the message just received
  history_.clear();
  notes_.clear();
  began_us_.clear();
  parts_.clear();
  names_.clear();
  frame_ms_.clear();
}

void Monitor::take(RunReader::Update update, double now_s) {
  const RunReader& run = inbox_.run();
  if (run.header() == nullptr) return;
  if (!has_run_ || run.run_id() != run_id_ || run.instance() != instance_) begin_run(now_s);
  switch (update) {
    case RunReader::Update::kRun:
      name_parts();
      break;
    case RunReader::Update::kEvents:
      take_events();
      break;
    case RunReader::Update::kTouching:
      drop_unseen_ends();
      break;
    case RunReader::Update::kFrameStats:
      take_frame_stats();
      break;
    default:
      break;
  }
  if (history_.empty() || now_s - history_.back().now_s >= kHistoryStep_s) {
    history_.push_back(now(now_s));
    while (history_.size() > 2 && now_s - history_[1].now_s >= kRecent_s) history_.pop_front();
  }
}

void Monitor::name_parts() {
  const run_description_t& run = *inbox_.run().run();
  parts_.clear();
  names_.clear();
  for (const char* name : {"obstacle", "whole body"}) parts_.emplace_back().name = name;
  std::map<std::string, size_t> index;
  for (const model_t& model : run.models) {
    std::vector<size_t>& names = names_.emplace_back();
    for (const part_t& part : model.parts) {
      const auto [at, is_new] = index.emplace(part.name, parts_.size());
      if (is_new) parts_.emplace_back().name = printable(part.name);
      names.push_back(at->second);
    }
  }
}

size_t Monitor::part_of(uint32_t body, uint32_t part) const {
  if (part == kWholeBody) return kWhole;
  const run_description_t& run = *inbox_.run().run();
  if (body >= run.model_of_avatar.size()) return kObstacle;
  return names_[static_cast<size_t>(run.model_of_avatar[body])][part];
}

void Monitor::take_events() {
  const RunReader& run = inbox_.run();
  const int64_t utime_us = run.header()->utime_us;
  const bool has_names = run.run() != nullptr;
  for (const PairEvent& event : run.new_events()) {
    const PairKey pair = event.pair;
    Note note{pair, event.kind, event.level, utime_us, -1};
    const bool begins = note.kind == EventKind::kBegin;
    if (begins) {
      began_us_[pair] = utime_us;
    } else if (const auto began = began_us_.find(pair); began != began_us_.end()) {
      note.lasted_s = static_cast<double>(utime_us - began->second) * 1e-6;
      began_us_.erase(began);
    }
    ++(begins ? sums_.begins : sums_.ends);
    if (has_names) {
      PartTotal* sides[] = {&parts_[part_of(pair.a(), pair.part_a())],
                            &parts_[part_of(pair.b(), pair.part_b())]};
      for (PartTotal* side : sides) {
        if (begins) ++side->begins;
        if (note.lasted_s > 0) side->contact_s += note.lasted_s;
        if (sides[0] == sides[1]) break;  // two hands are one contact of hands
      }
    }
    notes_.push_back(note);
    if (notes_.size() > kNotes) notes_.pop_front();
  }
}

void Monitor::drop_unseen_ends() {
  const RunReader::Touching& touching = inbox_.run().touching();
  std::erase_if(began_us_,
                [&touching](const auto& entry) { return !touching.contains(entry.first); });
}

void Monitor::take_frame_stats() {
  const frame_stats_t& m = *inbox_.run().frame_stats();
  // A malicious sender may state any number: sums must not overflow.
  const auto sane = [](int64_t n) { return std::clamp<int64_t>(n, 0, int64_t{1} << 40); };
  ++sums_.frames;
  for (size_t i = 0; i < kCullingStageCount; ++i) {
    sums_.updates[i] += sane(m.updates[i]);
    sums_.tests[i] += sane(m.tests[i]);
    sums_.passed[i] += sane(m.passed[i]);
    sums_.update_ns[i] += m.update_ns[i];
    sums_.test_ns[i] += m.test_ns[i];
  }
  const auto ns_of = [&m](Stage stage) { return m.stage_ns[static_cast<size_t>(stage)]; };
  sums_.other_ns += ns_of(Stage::kKinematics) + ns_of(Stage::kEvents);
  frame_ms_.push_back(static_cast<float>(m.frame_ns * 1e-6));
  if (frame_ms_.size() > kFrameTimes) frame_ms_.pop_front();
}

std::vector<Monitor::PartTotal> Monitor::parts() const {
  std::vector<PartTotal> out = parts_;
  if (!out.empty())
    for (const auto& [pair, level] : inbox_.run().touching()) {
      const size_t a = part_of(pair.a(), pair.part_a()), b = part_of(pair.b(), pair.part_b());
      ++out[a].touching;
      if (a != b) ++out[b].touching;
    }
  std::erase_if(out, [](const PartTotal& part) { return part.begins == 0 && part.touching == 0; });
  std::stable_sort(out.begin(), out.end(),
                   [](const PartTotal& x, const PartTotal& y) { return x.begins > y.begins; });
  return out;
}

Monitor::FrameTime Monitor::frame_time() const {
  if (frame_ms_.empty()) return {};
  std::vector<float> sorted(frame_ms_.begin(), frame_ms_.end());
  // Damaged times may be NaN, which breaks the order of a sort.
  std::erase_if(sorted, [](float ms) { return !(ms >= 0); });
  if (sorted.empty()) return {};
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return {static_cast<double>(frame_ms_.back()), static_cast<double>(*middle)};
}

}  // namespace throng
