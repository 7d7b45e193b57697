// validation runs the one-floor tests of RiMEA 4.1.0, IMO MSC.1/Circ.1533 and ISO 20414, and
// compares crowds with recorded people. Several seeds give one verdict.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/figure.h"
#include "crowd/steering/steering_rule.h"

namespace throng::validation {

// Tests judge by the criterion of the standard or of the recording, and report failures as
// failures.

/// A measured number and its recorded counterpart.
struct Reading {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string at;    ///< "0.5 m"
  std::string what;  ///< "flow"
  std::string unit;  ///< "1/s"; "" for shares and counts
  double simulated = kNone;
  double recorded = kNone;
  double low = kNone;  ///< bounds of acceptance, or the reported band
  double high = kNone;
  std::optional<bool> met{};  ///< true if within the bounds; none: not judged
  bool headline = false;      ///< summarises the other readings
  double worst = kNone;       ///< worst value of several seeds; `simulated` is their mean
};

enum class Verdict : uint8_t {
  kPass,
  kFail,
  kDiffers,  ///< deviates, as recorded people do; or the guideline excludes no model by it
  kSkipped   ///< a required file is missing
};
/// "pass", "fail", "differs" or "skipped".
const char* name_of(Verdict verdict);

struct Outcome {
  bool passed = false;
  bool differs = false;  ///< counts only if `passed`
  bool skipped = false;
  std::string measured;  ///< result in a sentence, with units
  int wall_crossings = 0;
  int unplaced = 0;          ///< people who could not be placed
  double max_overlap_m = 0;  ///< maximum overlap of two steering discs
  std::vector<Figure> figures;
  std::vector<Reading> readings;

  Verdict verdict() const;
};

/// Conditions of a run, the same for all tests.
struct Conditions {
  SteeringKind model = SteeringRule{}.model;
  uint64_t seed = 1;
  /// Folder of the recordings that some tests need; empty: these tests are skipped.
  std::filesystem::path recordings{};

  /// Seed of one of the runs of a test; distinct for all seeds and runs.
  uint64_t seed_of_run(uint64_t run, uint64_t runs) const { return (seed - 1) * runs + run + 1; }
  Conditions of_run(uint64_t run, uint64_t runs) const {
    Conditions one = *this;
    one.seed = seed_of_run(run, runs);
    return one;
  }
};

/// One experiment; standards that share it share its outcome.
struct Test {
  std::vector<std::string> ids;     ///< "rimea_6", "imo_6", "iso_4"
  std::vector<std::string> titles;  ///< indexed by id: "RiMEA 6: ..."
  std::string setup;                ///< geometry, people, steering
  std::string criterion;
  std::function<Outcome(const Conditions&)> run;

  bool has(const std::string& id) const;
};

/// Runs a test. It fails if people could not be placed.
Outcome run_test(const Test& test, const Conditions& conditions);

/// Tests of the standards, in the order of the report.
const std::vector<Test>& all_tests();

/// Comparisons with recorded people, with default steering parameters.
const std::vector<Test>& empirical_tests();

// By subject; each in a separate file.
std::vector<Test> walking_tests();
std::vector<Test> density_tests();
std::vector<Test> door_tests();
std::vector<Test> counterflow_tests();
std::vector<Test> route_tests();
std::vector<Test> recorded_door_tests();
std::vector<Test> recorded_speed_tests();
std::vector<Test> passing_tests();
std::vector<Test> spreading_tests();
std::vector<Test> behaviour_tests();
std::vector<Test> contact_tests();
std::vector<Test> social_group_tests();
std::vector<Test> spacing_tests();
std::vector<Test> counterflow_corridor_tests();

/// Files that Conditions::recordings must contain.
std::vector<std::string> recording_files();

/// Normalises an id: "RiMEA 6", "rimea-6" and "rimea_6" are equal.
std::string normal_id(const std::string& id);

/// Speed in m/s at a density in people per m2 (Weidmann 1993).
double weidmann_mps(double density_per_m2);

/// Outcome of a test with one seed.
struct SeedOutcome {
  uint64_t seed = 0;
  Outcome outcome;
  double wall_s = 0;
};

/// Combines seeds: fails if any seed fails, differs if any differs, is skipped if all are. A single
/// seed's outcome is unchanged. Readings are matched by `at` and `what`, and averaged over the
/// seeds that have one.
Outcome across_seeds(std::span<const SeedOutcome> seeds);

/// Distance of a value from the bounds of a reading: positive outside, 0 without bounds.
double excess(const Reading& reading, double value);

}  // namespace throng::validation
