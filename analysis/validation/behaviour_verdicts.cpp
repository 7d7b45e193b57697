#include "analysis/validation/behaviour_verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/validation/validation.h"

namespace throng::validation {
namespace {

constexpr double kNone = Reading::kNone;

}  // namespace

Judgement judge_accelerations(std::span<const SceneAccelerations> scenes) {
  constexpr double kMax_mps2 = 5;
  Judgement out;
  double worst_mps2 = 0;
  uint64_t samples = 0;
  std::string worst_where;
  out.passed = !scenes.empty();
  for (const SceneAccelerations& scene : scenes) {
    const bool met = scene.samples > 0 && scene.at_999_mps2 < kMax_mps2;
    out.passed = out.passed && met;
    samples += scene.samples;
    out.readings.push_back({scene.where, "acceleration, 99.9 % are at most", "m/s2",
                            scene.at_999_mps2, kNone, kNone, kMax_mps2, met});
    if (scene.at_999_mps2 < worst_mps2) continue;
    worst_mps2 = scene.at_999_mps2;
    worst_where = scene.where;
  }
  out.readings.push_back({"worst scene", "acceleration, 99.9 % are at most", "m/s2", worst_mps2,
                          kNone, kNone, kMax_mps2, out.passed, true});
  out.summary =
      fmt::format("99.9 % are at most {:.2f} m/s2 in the worst scene ({}); {} accelerations",
                  worst_mps2, worst_where, samples);
  return out;
}

Judgement judge_queues(std::span<const QueueTurning> queues) {
  constexpr double kMaxTurns_per_min = 1;
  constexpr double kMinWaited_s = 300;
  Judgement out;
  out.passed = !queues.empty();
  double highest = 0;
  for (const QueueTurning& queue : queues) {
    const double minutes = queue.waited_s / 60;
    const double net = minutes > 0 ? queue.net_turns / minutes : kNone;
    const bool met = queue.waited_s >= kMinWaited_s && net <= kMaxTurns_per_min;
    out.passed = out.passed && met;
    highest = std::max(highest, net);
    out.readings.push_back(
        {queue.where, "turns, net", "1/min", net, kNone, kNone, kMaxTurns_per_min, met});
    out.readings.push_back({queue.where,
                            "turns in both directions",
                            "1/min",
                            minutes > 0 ? queue.all_turns / minutes : kNone,
                            kNone,
                            kNone,
                            kNone,
                            {}});
    out.readings.push_back({queue.where, "waited", "person s", queue.waited_s, kNone, kMinWaited_s,
                            kNone, queue.waited_s >= kMinWaited_s});
    out.summary +=
        fmt::format("{}{}: {:.2f} turns per minute net, {:.2f} in both directions",
                    out.summary.empty() ? "" : "; ", queue.where, net, queue.all_turns / minutes);
  }
  out.readings.push_back({"worst queue", "turns, net", "1/min", highest, kNone, kNone,
                          kMaxTurns_per_min, out.passed, true});
  return out;
}

Judgement judge_audience(std::span<const double> facing_shares) {
  constexpr double kMinShare = 0.95;
  Judgement out;
  const double lowest =
      facing_shares.empty() ? 0 : *std::min_element(facing_shares.begin(), facing_shares.end());
  const double mean = facing_shares.empty()
                          ? 0
                          : std::accumulate(facing_shares.begin(), facing_shares.end(), 0.0) /
                                static_cast<double>(facing_shares.size());
  out.passed = lowest >= kMinShare;
  out.readings = {{"worst moment", "share that faces the stage", "", lowest, kNone, kMinShare, 1,
                   out.passed, true},
                  {"all moments", "share that faces the stage", "", mean, kNone, kMinShare, 1, {}}};
  out.summary = fmt::format(
      "{:.1f} % face the stage within 20 degrees on average, {:.1f} % at the worst moment",
      100 * mean, 100 * lowest);
  return out;
}

Judgement judge_standing(std::span<const DenseStanding> crowds) {
  constexpr double kOff = 0.01, kMaxOverlap_m = 0.01;
  Judgement out;
  out.passed = !crowds.empty();
  for (const DenseStanding& crowd : crowds) {
    const std::string at = fmt::format("{:g} per m2", crowd.target_per_m2);
    const double low = (1 - kOff) * crowd.target_per_m2, high = (1 + kOff) * crowd.target_per_m2;
    const bool placed = crowd.placed_per_m2 >= low && crowd.placed_per_m2 <= high;
    const bool clear = crowd.max_overlap_m < kMaxOverlap_m;
    out.passed = out.passed && placed && clear;
    out.readings.push_back(
        {at, "placed", "1/m2", crowd.placed_per_m2, kNone, low, high, placed, true});
    out.readings.push_back({at, "maximum overlap of bodies", "m", crowd.max_overlap_m, kNone, kNone,
                            kMaxOverlap_m, clear});
    out.summary += fmt::format("{}{:g} requested, {:.2f} placed ({:.1f} mm overlap)",
                               out.summary.empty() ? "" : ", ", crowd.target_per_m2,
                               crowd.placed_per_m2, 1000 * std::max(0.0, crowd.max_overlap_m));
  }
  return out;
}

Judgement judge_encounters(std::span<const EncounterOutcome> met) {
  Judgement out;
  struct Sum {
    int all = 0, touch = 0, close = 0;
    double nearest_m = 1e9;
  };
  std::array<Sum, kEncounterKinds + 1> sums;
  for (const EncounterOutcome& each : met)
    for (Sum* const sum : {&sums[static_cast<size_t>(each.kind)], &sums[kEncounterKinds]}) {
      ++sum->all;
      sum->touch += each.touched;
      sum->close += each.nearest_m < Encounter::kDisc_m;
      sum->nearest_m = std::min(sum->nearest_m, each.nearest_m);
    }
  const Sum& all = sums[kEncounterKinds];
  out.passed = all.all > 0 && all.touch == 0;
  for (size_t i = 0; i <= kEncounterKinds; ++i) {
    const Sum& sum = sums[i];
    if (sum.all == 0) continue;
    const bool is_all = i == kEncounterKinds;
    const std::string at = is_all ? "all" : name_of(static_cast<EncounterKind>(i));
    const auto count = static_cast<double>(sum.all);
    out.readings.push_back(
        {at, "share that touch", "", sum.touch / count, kNone, 0, 0, sum.touch == 0, is_all});
    out.readings.push_back({at,
                            fmt::format("share nearer than {:g} m", Encounter::kDisc_m),
                            "",
                            sum.close / count,
                            kNone,
                            kNone,
                            kNone,
                            {},
                            is_all});
    out.readings.push_back({at, "nearest middles", "m", sum.nearest_m, kNone, kNone, kNone, {}});
  }
  out.summary = fmt::format(
      "{} of {} touch ({} head-on, {} crossing, {} same way); in {} centres come closer than "
      "{:g} m, minimum {:.2f} m",
      all.touch, all.all, sums[0].touch, sums[1].touch, sums[2].touch, all.close,
      Encounter::kDisc_m, all.all > 0 ? all.nearest_m : kNone);
  return out;
}

Judgement judge_spacing(std::span<const SpeedAndSpacing::Spacing> simulated,
                        std::span<const SpeedAndSpacing::Spacing> recorded) {
  constexpr std::array<double, 3> kWithin_m = {0.12, 0.08, 0.08};
  Judgement out;
  int expected = 0, reached = 0, met = 0;
  double max_off_m = 0;
  for (size_t i = 0; i < recorded.size(); ++i) {
    if (recorded[i].pairs < kMinPairs) continue;
    ++expected;
    const bool is_reached = simulated[i].pairs >= kMinPairs;
    reached += is_reached;
    bool is_near = true;
    for (size_t k = 0; k < kWithin_m.size(); ++k) {
      const double recorded_m = recorded[i].quantiles_m[k];
      Reading reading{
          fmt::format("{} per m2, {}", recorded[i].at, recorded[i].is_ahead ? "ahead" : "beside"),
          fmt::format("{:g} % nearer than", 100 * SpeedAndSpacing::kQuantiles[k]),
          "m",
          kNone,
          recorded_m,
          recorded_m - kWithin_m[k],
          recorded_m + kWithin_m[k],
          {}};
      if (is_reached) {
        const double off_m = simulated[i].quantiles_m[k] - recorded_m;
        reading.simulated = simulated[i].quantiles_m[k];
        reading.met = std::abs(off_m) <= kWithin_m[k];
        is_near = is_near && *reading.met;
        if (std::abs(off_m) > std::abs(max_off_m)) max_off_m = off_m;
      }
      out.readings.push_back(std::move(reading));
    }
    met += is_reached && is_near;
  }
  const bool enough = expected > 0 && 2 * reached >= expected;
  out.passed = enough && met == reached;
  out.readings.push_back({"all cells", "cells as recorded", "", static_cast<double>(met), kNone,
                          static_cast<double>(reached), static_cast<double>(reached),
                          met == reached && enough, true});
  out.readings.push_back({"all cells", "cells reached", "", static_cast<double>(reached), kNone,
                          0.5 * expected, static_cast<double>(expected), enough});
  out.summary = fmt::format(
      "{} of {} cells of density and side as recorded, {} of the recording's {} reached; at most "
      "{:+.2f} m off",
      met, reached, reached, expected, max_off_m);
  return out;
}

Judgement judge_social_groups(std::span<const GroupCohesion> places, const GroupExits& exits) {
  constexpr double kMinShare = 0.95;
  Judgement out;
  out.passed = !places.empty();
  for (const GroupCohesion& place : places) {
    const bool met = place.moments > 0 && place.share() >= kMinShare;
    out.passed = out.passed && met;
    out.readings.push_back({place.where, "share of the time within 3 m of a member", "",
                            place.share(), kNone, kMinShare, 1, met, true});
    out.summary += fmt::format("{}{}: within 3 m of a member {:.1f} % of the time",
                               out.summary.empty() ? "" : "; ", place.where, 100 * place.share());
  }
  const double share = exits.groups > 0 ? static_cast<double>(exits.by_one_exit) / exits.groups : 0;
  const bool one_exit = exits.groups > 0 && share >= kMinShare;
  out.readings.push_back({"two exits", "share of the groups that leave by one", "", share, kNone,
                          kMinShare, 1, one_exit, true});
  out.readings.push_back({"two exits", "people left behind", "",
                          static_cast<double>(exits.left_behind), kNone, 0, 0,
                          exits.left_behind == 0});
  out.passed = out.passed && one_exit && exits.left_behind == 0;
  out.summary += fmt::format("; {} of {} groups leave by one exit, {} people do not leave",
                             exits.by_one_exit, exits.groups, exits.left_behind);
  return out;
}

double CountedContacts::per_person_min() const {
  return person_s > 0 ? 2 * 60 * static_cast<double>(contacts) / person_s : kNone;
}

double CountedContacts::error_per_person_min() const {
  const double error = std::sqrt(std::max<double>(1, static_cast<double>(contacts)));
  return person_s > 0 ? 2 * 60 * error / person_s : kNone;
}

void PlaceContacts::add(const std::vector<CountedContacts>& more) {
  levels.resize(std::max(levels.size(), more.size()));
  for (size_t i = 0; i < more.size(); ++i) {
    levels[i].contacts += more[i].contacts;
    levels[i].person_s += more[i].person_s;
  }
}

namespace {

CountedContacts at_level(const PlaceContacts& place, size_t level) {
  return level < place.levels.size() ? place.levels[level] : CountedContacts{};
}

CountedContacts of_all(std::span<const PlaceContacts> places, size_t level) {
  CountedContacts sum;
  for (const PlaceContacts& place : places) {
    const CountedContacts counted = at_level(place, level);
    sum.contacts += counted.contacts;
    sum.person_s += counted.person_s;
  }
  return sum;
}

/// Fall of the contact rate from the level below, in standard errors.
double fall_in_errors(const CountedContacts& below, const CountedContacts& level) {
  return (below.per_person_min() - level.per_person_min()) /
         std::hypot(below.error_per_person_min(), level.error_per_person_min());
}

/// Reading of a level before it is judged; the lower bound is NaN if only the upper one counts.
Reading contact_reading(size_t level, const CountedContacts& simulated,
                        double two_sided_from_per_m2) {
  constexpr double kMaxContacts = 1, kLow = 0.5, kHigh = 1.5, kWithin = 0.5;
  const auto& [from_per_m2, to_per_m2, recorded] = recorded_contacts()[level];
  const bool is_two_sided = from_per_m2 >= two_sided_from_per_m2;
  const double low = level == 0 ? 0 : std::min(kLow * recorded, recorded - kWithin);
  const double high = level == 0 ? kMaxContacts : std::max(kHigh * recorded, recorded + kWithin);
  return {fmt::format("{:g} to {:g} per m2", from_per_m2, to_per_m2),
          "contacts",
          "per person and minute",
          simulated.per_person_min(),
          recorded,
          is_two_sided ? low : kNone,
          high,
          {}};
}

void list_places(std::span<const PlaceContacts> places, size_t level, const std::string& at,
                 Judgement& out) {
  for (const PlaceContacts& place : places) {
    const CountedContacts counted = at_level(place, level);
    if (counted.person_s <= 0) continue;
    out.readings.push_back({at, fmt::format("contacts, {}", place.name), "per person and minute",
                            counted.per_person_min()});
    out.readings.push_back(
        {at, fmt::format("watched, {}", place.name), "person min", counted.person_s / 60});
  }
}

}  // namespace

Judgement judge_contacts(std::span<const PlaceContacts> places, double two_sided_from_per_m2) {
  constexpr double kChance = 1.645;  // one-sided, 95 %
  constexpr size_t kMinLevels = 3;
  Judgement out;
  size_t reached = 0, as_recorded = 0;
  CountedContacts below;
  bool falls = false, has_low = false;
  std::string list, outside;
  for (size_t i = 0; i < recorded_contacts().size(); ++i) {
    const CountedContacts simulated = of_all(places, i);
    Reading reading = contact_reading(i, simulated, two_sided_from_per_m2);
    if (simulated.person_s >= 60 * kMinPersonMinutes) {
      const bool is_fewer = reached > 0 && fall_in_errors(below, simulated) > kChance;
      const bool is_recorded = excess(reading, reading.simulated) <= 0;
      falls = falls || is_fewer;
      has_low = has_low || !std::isnan(reading.low);
      reading.met = is_recorded && !is_fewer;
      reading.headline = true;
      as_recorded += is_recorded;
      below = simulated;
      ++reached;
      list += fmt::format("{}{:.2f}", list.empty() ? "" : ", ", reading.simulated);
      if (!is_recorded)
        outside += fmt::format("; {} {:.2f}, {} {:.2f}", reading.at, reading.simulated,
                               reading.simulated > reading.high ? "at most" : "at least",
                               reading.simulated > reading.high ? reading.high : reading.low);
    }
    out.readings.push_back(reading);
    out.readings.push_back(
        {reading.at, "watched", "person min", simulated.person_s / 60, kNone, kMinPersonMinutes});
    list_places(places, i, reading.at, out);
  }
  out.passed = reached >= kMinLevels && has_low && as_recorded == reached && !falls;
  out.summary = fmt::format(
      "{} of {} levels of density within their bounds; {} contacts per person and minute from the "
      "lowest on{}{}{}",
      as_recorded, reached, list, outside, falls ? "; fewer at a higher density" : "",
      has_low ? "" : "; no level with a lower bound was reached");
  return out;
}

}  // namespace throng::validation
