#include "apps/commands/validation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/output/text_file.h"
#include "base/text.h"
#include "bench/version_json.h"

namespace throng {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using validation::Reading;
using validation::SeedOutcome;
using validation::Test;
using validation::Verdict;

constexpr const char* kWallsId = "walls";
constexpr const char* kWallsTitle = "No wall is crossed in any of the tests";
constexpr const char* kWallsCriterion = "0 moves into or through a wall";

int walls_crossed(const std::vector<ValidationRun>& runs) {
  int sum = 0;
  for (const ValidationRun& run : runs) sum += run.outcome.wall_crossings;
  return sum;
}

std::string walls_measured(const std::vector<ValidationRun>& runs) {
  return fmt::format("{} moves", walls_crossed(runs));
}

/// Ids of the tests with a verdict; includes `walls` among the failed.
std::vector<std::string> ids_with(const std::vector<ValidationRun>& runs, Verdict verdict) {
  std::vector<std::string> ids;
  for (const ValidationRun& run : runs)
    if (run.outcome.verdict() == verdict)
      ids.insert(ids.end(), run.test->ids.begin(), run.test->ids.end());
  if (verdict == Verdict::kFail && walls_crossed(runs) > 0) ids.push_back(kWallsId);
  return ids;
}

std::string in_brackets(const std::vector<std::string>& ids) {
  return ids.empty() ? "" : fmt::format(" ({})", fmt::join(ids, ", "));
}

const char* verdict(bool passed) { return passed ? "pass" : "fail"; }

std::string verdict_in_table(std::string_view verdict) {
  return verdict == "fail" || verdict == "differs" ? fmt::format("**{}**", verdict)
                                                   : std::string(verdict);
}

std::string anchor(const Test& test) {
  std::string text;
  for (const std::string& id : test.ids) text += fmt::format("<a id=\"{}\"></a>", id);
  return text;
}

std::string number(double value) { return std::isnan(value) ? "" : fmt::format("{:.4g}", value); }

std::string readings_table(const ValidationRun& run) {
  const std::vector<Reading>& readings = run.outcome.readings;
  if (readings.empty()) return "";
  const bool several = run.seeds.size() > 1;
  std::string text = several ? "| where | what | mean | worst | recorded | from | to | |\n"
                               "|---|---|---|---|---|---|---|---|\n"
                             : "| where | what | simulated | recorded | from | to | "
                               "|\n|---|---|---|---|---|---|---|\n";
  for (const Reading& each : readings)
    append(text, "| {} | {}{} | {} | {}{} | {} | {} | {} |\n", each.at, each.what,
           each.unit.empty() ? "" : ", " + each.unit, number(each.simulated),
           several ? number(each.worst) + " | " : "", number(each.recorded), number(each.low),
           number(each.high), each.met ? (*each.met ? "met" : "**not met**") : "no limit");
  return text + "\n";
}

/// Value of a reading for each seed; null if there is none.
Json by_seed(const ValidationRun& run, const Reading& like) {
  Json out = Json::array();
  for (const SeedOutcome& seed : run.seeds) {
    Json value;
    for (const Reading& each : seed.outcome.readings)
      if (each.at == like.at && each.what == like.what) value = each.simulated;
    out.push_back(value);
  }
  return out;
}

Json readings_json(const ValidationRun& run) {
  const bool several = run.seeds.size() > 1;
  Json out = Json::array();
  for (const Reading& each : run.outcome.readings) {
    out.push_back({{"at", each.at},
                   {"what", each.what},
                   {"unit", each.unit},
                   {"simulated", each.simulated},
                   {"recorded", each.recorded},
                   {"from", each.low},
                   {"to", each.high},
                   {"met", each.met ? Json(*each.met) : Json()}});
    if (!several) continue;
    out.back()["worst"] = each.worst;
    out.back()["by_seed"] = by_seed(run, each);
  }
  return out;
}

Json seeds_json(const ValidationRun& run) {
  Json out = Json::array();
  for (const SeedOutcome& seed : run.seeds)
    out.push_back({{"seed", seed.seed},
                   {"verdict", name_of(seed.outcome.verdict())},
                   {"measured", seed.outcome.measured},
                   {"wall_crossings", seed.outcome.wall_crossings},
                   {"unplaced", seed.outcome.unplaced},
                   {"max_overlap_m", seed.outcome.max_overlap_m},
                   {"wall_s", seed.wall_s}});
  return out;
}

double wall_s(const ValidationRun& run) {
  double sum = 0;
  for (const SeedOutcome& seed : run.seeds) sum += seed.wall_s;
  return sum;
}

/// "seed 1", "seeds 1 to 5"
std::string seeds_of(const std::vector<ValidationRun>& runs) {
  uint64_t first = UINT64_MAX, last = 0;
  for (const ValidationRun& run : runs)
    for (const SeedOutcome& seed : run.seeds) {
      first = std::min(first, seed.seed);
      last = std::max(last, seed.seed);
    }
  return first >= last ? fmt::format("seed {}", last) : fmt::format("seeds {} to {}", first, last);
}

std::string section(const ValidationRun& run) {
  const Test& test = *run.test;
  std::string text = fmt::format("## {}\n\n{}\n\n", test.titles.front(), anchor(test));
  if (test.titles.size() > 1) {
    text += "The same experiment serves";
    for (size_t i = 1; i < test.titles.size(); ++i)
      text += fmt::format("{} {}", i == 1 ? "" : " and", test.titles[i]);
    text += ".\n\n";
  }
  text +=
      fmt::format("- Setup: {}\n- Criterion: {}\n- Measured: {}\n- Verdict: **{}**\n\n", test.setup,
                  test.criterion, run.outcome.measured, name_of(run.outcome.verdict()));
  text += readings_table(run);
  for (const Figure& figure : run.outcome.figures)
    text += fmt::format("![{}]({}.svg)\n\n*{}* {}\n\n", figure.title, figure.id, figure.title,
                        figure.caption);
  return text;
}

}  // namespace

ValidationCount count_of(const std::vector<ValidationRun>& runs) {
  ValidationCount count;
  for (const ValidationRun& run : runs) {
    const auto tests = static_cast<int>(run.test->ids.size());
    switch (run.outcome.verdict()) {
      case Verdict::kPass:
        count.passed += tests;
        break;
      case Verdict::kFail:
        count.failed += tests;
        break;
      case Verdict::kDiffers:
        count.differ += tests;
        break;
      case Verdict::kSkipped:
        count.skipped += tests;
        break;
    }
  }
  if (!runs.empty()) ++(walls_crossed(runs) == 0 ? count.passed : count.failed);
  return count;
}

std::string verdict_table(const std::vector<ValidationRun>& runs) {
  std::string text;
  const auto row = [&text](const char* verdict, const std::string& id, const std::string& title,
                           const std::string& measured) {
    append(text, "{:<7}  {:<9} {}\n{:<19}{}\n", verdict, id, title, "", measured);
  };
  for (const ValidationRun& run : runs)
    for (size_t i = 0; i < run.test->ids.size(); ++i)
      row(name_of(run.outcome.verdict()), run.test->ids[i], run.test->titles[i],
          i == 0 ? run.outcome.measured : "as " + run.test->ids[0]);
  if (!runs.empty())
    row(verdict(walls_crossed(runs) == 0), kWallsId, kWallsTitle, walls_measured(runs));
  const ValidationCount count = count_of(runs);
  text += fmt::format("\n{} passed, {} failed{}", count.passed, count.failed,
                      in_brackets(ids_with(runs, Verdict::kFail)));
  if (count.differ > 0)
    text += fmt::format(", {} differ{}, which is measured and neither passed nor failed",
                        count.differ, in_brackets(ids_with(runs, Verdict::kDiffers)));
  if (count.skipped > 0) text += fmt::format(", {} skipped", count.skipped);
  return text + "\n";
}

std::string validation_json(const std::vector<ValidationRun>& runs, bool stopped_early) {
  Json tests = Json::array();
  for (const ValidationRun& run : runs)
    for (size_t i = 0; i < run.test->ids.size(); ++i) {
      tests.push_back({{"id", run.test->ids[i]},
                       {"title", run.test->titles[i]},
                       {"verdict", name_of(run.outcome.verdict())},
                       {"measured", run.outcome.measured},
                       {"criterion", run.test->criterion},
                       {"setup", run.test->setup},
                       {"wall_crossings", run.outcome.wall_crossings},
                       {"unplaced", run.outcome.unplaced},
                       {"max_overlap_m", run.outcome.max_overlap_m},
                       {"wall_s", wall_s(run)}});
      if (run.seeds.size() > 1) tests.back()["seeds"] = seeds_json(run);
      if (!run.outcome.readings.empty()) tests.back()["readings"] = readings_json(run);
    }
  if (!runs.empty())
    tests.push_back({{"id", kWallsId},
                     {"title", kWallsTitle},
                     {"verdict", verdict(walls_crossed(runs) == 0)},
                     {"measured", walls_measured(runs)},
                     {"criterion", kWallsCriterion}});
  const ValidationCount count = count_of(runs);
  const Json json = {{"throng", version_json()}, {"stopped_early", stopped_early},
                     {"tests", tests},           {"passed", count.passed},
                     {"failed", count.failed},   {"differ", count.differ},
                     {"skipped", count.skipped}};
  return json.dump(2) + "\n";
}

void write_validation_report(const std::vector<ValidationRun>& runs, const fs::path& folder) {
  const ValidationCount count = count_of(runs);
  std::string text = fmt::format(
      "# Validation report\n\nWritten by `throng validate --out`; docs/validation.md explains it. "
      "{} of {} tests pass; {} fail{}{}{}. Measured with {}.\n\n| test | verdict | measured | "
      "criterion "
      "|\n|---|---|---|---|\n",
      count.passed, count.passed + count.failed + count.differ, count.failed,
      in_brackets(ids_with(runs, Verdict::kFail)),
      count.differ == 0
          ? ""
          : fmt::format("; {} differ{}, which is measured and neither passed nor failed",
                        count.differ, in_brackets(ids_with(runs, Verdict::kDiffers))),
      count.skipped == 0 ? "" : fmt::format("; {} skipped", count.skipped), seeds_of(runs));
  for (const ValidationRun& run : runs)
    for (size_t i = 0; i < run.test->ids.size(); ++i)
      text += fmt::format("| [{}](#{}) | {} | {} | {} |\n", run.test->titles[i], run.test->ids[i],
                          verdict_in_table(name_of(run.outcome.verdict())),
                          i == 0 ? run.outcome.measured : "the same run", run.test->criterion);
  text += fmt::format("| {} | {} | {} | {} |\n\n", kWallsTitle,
                      verdict_in_table(verdict(walls_crossed(runs) == 0)), walls_measured(runs),
                      kWallsCriterion);
  for (const ValidationRun& run : runs) {
    text += section(run);
    for (const Figure& figure : run.outcome.figures) draw(figure, folder);
  }
  while (text.ends_with("\n\n")) text.pop_back();
  write_text(folder / "report.md", text);
}

}  // namespace throng
