#include "analysis/validation/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

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

Outcome carry_out(const Test& test, const Conditions& conditions) {
  Outcome outcome = test.run(conditions);
  if (outcome.unplaced > 0) {
    outcome.passed = false;
    outcome.measured += fmt::format("; {} people found no room at the start", outcome.unplaced);
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

const std::vector<Test>& reality_tests() {
  static const std::vector<Test> tests = [] {
    std::vector<Test> all;
    for (const auto& part : {recorded_door_tests(), recorded_speed_tests(), passing_tests(),
                             spreading_tests(), behaviour_tests(), contact_tests(),
                             companion_tests(), spacing_tests(), two_way_corridor_tests()})
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
  constexpr double kMost_per_m2 = 5.4;
  if (density_per_m2 <= 0) return kFree_mps;
  if (density_per_m2 >= kMost_per_m2) return 0;
  return kFree_mps * (1 - std::exp(-kGamma * (1 / density_per_m2 - 1 / kMost_per_m2)));
}

}  // namespace throng::validation
