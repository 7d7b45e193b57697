#include "analysis/validation/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <tuple>

namespace throng::validation {

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "fail";
    case Verdict::kDiffers:
      return "differs";
    case Verdict::kSkipped:
      return "skipped";
  }
  return "";
}

Verdict Outcome::verdict() const {
  if (skipped) return Verdict::kSkipped;
  if (!passed) return Verdict::kFail;
  return differs ? Verdict::kDiffers : Verdict::kPass;
}

bool Test::has(const std::string& id) const {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

Outcome run_test(const Test& test, const Conditions& conditions) {
  Outcome outcome = test.run(conditions);
  if (outcome.unplaced > 0) {
    outcome.passed = false;
    outcome.measured +=
        fmt::format("; {} people could not be placed at the start", outcome.unplaced);
  }
  return outcome;
}

const std::vector<Test>& all_tests() {
  static const std::vector<Test> tests = [] {
    std::vector<Test> all;
    for (const auto& part :
         {walking_tests(), density_tests(), door_tests(), counterflow_tests(), route_tests()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return tests;
}

const std::vector<Test>& empirical_tests() {
  static const std::vector<Test> tests = [] {
    std::vector<Test> all;
    for (const auto& part : {recorded_door_tests(), recorded_speed_tests(), passing_tests(),
                             spreading_tests(), behaviour_tests(), contact_tests(),
                             social_group_tests(), spacing_tests(), counterflow_corridor_tests()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return tests;
}

std::string normal_id(const std::string& id) {
  std::string out;
  for (const char c : id)
    out +=
        c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

double weidmann_mps(double density_per_m2) {
  constexpr double kFree_mps = 1.34;
  constexpr double kGamma = 1.913;
  constexpr double kMax_per_m2 = 5.4;
  if (density_per_m2 <= 0) return kFree_mps;
  if (density_per_m2 >= kMax_per_m2) return 0;
  return kFree_mps * (1 - std::exp(-kGamma * (1 / density_per_m2 - 1 / kMax_per_m2)));
}

namespace {

int unmet(const Outcome& outcome) {
  return static_cast<int>(
      std::count_if(outcome.readings.begin(), outcome.readings.end(),
                    [](const Reading& reading) { return reading.met && !*reading.met; }));
}

/// Order of outcomes, greater is worse: failure, then number of unmet readings, then the excess of
/// headlines.
auto badness(const Outcome& outcome) {
  double off = 0;
  for (const Reading& reading : outcome.readings)
    if (reading.headline && !std::isnan(reading.simulated))
      off += excess(reading, reading.simulated);
  return std::tuple(outcome.verdict() == Verdict::kFail, outcome.differs, unmet(outcome), off);
}

const Reading* find(const Outcome& outcome, const Reading& like) {
  const auto found = std::find_if(
      outcome.readings.begin(), outcome.readings.end(),
      [&](const Reading& each) { return each.at == like.at && each.what == like.what; });
  return found == outcome.readings.end() ? nullptr : &*found;
}

Reading across(const Reading& first, std::span<const SeedOutcome> seeds) {
  Reading out = first;
  double sum = 0, worst_excess = 0;
  int count = 0;
  out.met.reset();
  for (const SeedOutcome& seed : seeds) {
    const Reading* reading = find(seed.outcome, first);
    if (reading == nullptr) continue;
    if (reading->met) out.met = out.met.value_or(true) && *reading->met;
    if (std::isnan(reading->simulated)) continue;
    const double off = excess(*reading, reading->simulated);
    if (count == 0 || off > worst_excess) {
      worst_excess = off;
      out.worst = reading->simulated;
    }
    sum += reading->simulated;
    ++count;
  }
  out.simulated = count > 0 ? sum / count : Reading::kNone;
  return out;
}

std::string sentence(std::span<const SeedOutcome> seeds, const SeedOutcome& worst,
                     const std::vector<Reading>& readings) {
  const auto with = [&](Verdict verdict) {
    return std::count_if(seeds.begin(), seeds.end(), [&](const SeedOutcome& each) {
      return each.outcome.verdict() == verdict;
    });
  };
  const auto passed = with(Verdict::kPass), differ = with(Verdict::kDiffers);
  std::string text = fmt::format("{} of {} seeds pass{}; {}seed {}: {}", passed, seeds.size(),
                                 differ == 0 ? "" : fmt::format(", {} differ", differ),
                                 readings.empty() && passed == std::ssize(seeds) ? "" : "worst, ",
                                 worst.seed, worst.outcome.measured);
  const auto is_named_twice = [&](const std::string& what) {
    return std::count_if(readings.begin(), readings.end(), [&](const Reading& each) {
             return each.headline && each.what == what;
           }) > 1;
  };
  std::string means;
  for (const Reading& reading : readings)
    if (reading.headline && !std::isnan(reading.simulated))
      means += fmt::format("{} {}{} {:.4g}{}{}", means.empty() ? "; means:" : ",", reading.what,
                           is_named_twice(reading.what) ? fmt::format(" ({})", reading.at) : "",
                           reading.simulated, reading.unit.empty() ? "" : " ", reading.unit);
  return text + means;
}

}  // namespace

double excess(const Reading& reading, double value) {
  double out = 0;
  bool is_judged = false;
  for (const double off : {reading.low - value, value - reading.high}) {
    if (std::isnan(off)) continue;
    out = is_judged ? std::max(out, off) : off;
    is_judged = true;
  }
  return out;
}

Outcome across_seeds(std::span<const SeedOutcome> seeds) {
  if (seeds.empty()) return {};
  Outcome out = seeds.front().outcome;
  if (seeds.size() == 1) return out;
  const auto has = [&](Verdict verdict) {
    return std::any_of(seeds.begin(), seeds.end(),
                       [&](const SeedOutcome& each) { return each.outcome.verdict() == verdict; });
  };
  out.passed = !has(Verdict::kFail);
  out.differs = out.passed && has(Verdict::kDiffers);
  out.skipped = out.passed && !out.differs && !has(Verdict::kPass);
  if (out.skipped) return out;
  for (const SeedOutcome& each : seeds.subspan(1)) {
    out.wall_crossings += each.outcome.wall_crossings;
    out.unplaced += each.outcome.unplaced;
    out.max_overlap_m = std::max(out.max_overlap_m, each.outcome.max_overlap_m);
    for (const Reading& reading : each.outcome.readings)
      if (find(out, reading) == nullptr) out.readings.push_back(reading);
  }
  for (Reading& reading : out.readings) reading = across(reading, seeds);
  const SeedOutcome& worst =
      *std::max_element(seeds.begin(), seeds.end(), [](const SeedOutcome& a, const SeedOutcome& b) {
        return badness(a.outcome) < badness(b.outcome);
      });
  out.figures = worst.outcome.figures;
  for (Figure& figure : out.figures)
    figure.caption +=
        fmt::format("{}Seed {}, the worst.", figure.caption.empty() ? "" : " ", worst.seed);
  out.measured = sentence(seeds, worst, out.readings);
  return out;
}

}  // namespace throng::validation
