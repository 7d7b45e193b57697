// The tests for one floor of RiMEA 4.1.0, IMO MSC.1/Circ.1533 and ISO 20414 that a crowd must pass
// before its runs count, how it stands beside recorded people, and what several seeds say together.
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

// The tests for one floor of RiMEA 4.1.0, IMO MSC.1/Circ.1533 and ISO 20414 that a crowd must pass
// before anybody believes it, and how it stands beside recorded people.
// A test measures and judges by the standard's own criterion, or by the recording's; what
// fails is reported as failed.

/// A number measured, beside what recorded people did.
struct Reading {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string at;    ///< "0.5 m"
  std::string what;  ///< "flow"
  std::string unit;  ///< "1/s"; "" for shares and counts
  double simulated = kNone;
  double recorded = kNone;
  double low = kNone;  ///< what is accepted, or the band that is reported
  double high = kNone;
  std::optional<bool> met{};  ///< none: not judged
  bool headline = false;      ///< sums up the others
  double worst = kNone;       ///< of several seeds, whose mean `ours` then is
};

enum class Verdict : uint8_t {
  kPass,
  kFail,
  kDiffers,  ///< measured only: recorded people do not meet the criterion either, or the guideline
             ///< excludes no model by it
  kSkipped   ///< what it needs is not there
};
/// "pass", "fail", "differs", "skipped".
const char* name_of(Verdict verdict);

struct Outcome {
  bool passed = false;
  bool differs = false;  ///< counts only where it passed otherwise
  bool skipped = false;
  std::string measured;  ///< in a sentence, with units
  int wall_crossings = 0;
  int unplaced = 0;          ///< people whom the test asks for and who found no room
  double max_overlap_m = 0;  ///< of two steering discs
  std::vector<Figure> figures;
  std::vector<Reading> readings;

  Verdict verdict() const;
};

/// What a test is run with; the same for all of them.
struct Conditions {
  SteeringKind model = SteeringRule{}.model;
  uint64_t seed = 1;
  /// The folder of the recordings that some tests are held against; empty: these are skipped.
  std::filesystem::path recordings{};

  /// Of a test that makes several runs: none of its seeds is another seed's.
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
  std::vector<std::string> titles;  ///< by id: "RiMEA 6: ..."
  std::string setup;                ///< geometry, people, how they steer
  std::string criterion;
  std::function<Outcome(const Conditions&)> run;

  bool has(const std::string& id) const;
};

/// Runs a test. It fails if somebody found no room.
Outcome run_test(const Test& test, const Conditions& conditions);

/// The standards' tests, in the order of the report.
const std::vector<Test>& all_tests();

/// How the crowd stands beside recorded people, with nothing set for a test.
const std::vector<Test>& empirical_tests();

// By subject; each in a file of its own.
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

/// Files that have to lie in Conditions::recordings.
std::vector<std::string> recording_files();

/// "RiMEA 6", "rimea-6" and "rimea_6" are the same.
std::string normal_id(const std::string& id);

/// Weidmann (1993): speed in m/s at a density in people per m2.
double weidmann_mps(double density_per_m2);

/// What several seeds say of a test: its verdict is that of all of them, its figures are their mean
/// and their worst.
/// Nothing is lost; each seed's own outcome stays beside what they come to together.
struct SeedOutcome {
  uint64_t seed = 0;
  Outcome outcome;
  double wall_s = 0;
};

/// Fails if any seed fails, differs if any differs, is skipped if all are. Of one seed: its own
/// outcome. Readings are matched by `at` and `what`; the mean is that of the seeds that have one.
Outcome across_seeds(std::span<const SeedOutcome> seeds);

/// How far a reading lies from what is accepted: above 0 outside of it, 0 where nothing is asked.
double excess(const Reading& reading, double value);

}  // namespace throng::validation
