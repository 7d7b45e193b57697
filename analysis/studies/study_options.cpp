#include "analysis/studies/study_options.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/errors.h"
#include "base/limits.h"
#include "culling/pair.h"

namespace throng {
namespace {

template <typename Kind, typename Kinds>
std::optional<Kind> kind_at(const Fields& fields, const std::string& key, const Kinds& kinds) {
  std::vector<std::string> names;
  for (const Kind kind : kinds) names.emplace_back(name_of(kind));
  const std::optional<size_t> found = fields.word(key, names);
  return found ? std::optional<Kind>(*(std::begin(kinds) + static_cast<ptrdiff_t>(*found)))
               : std::nullopt;
}

constexpr Range kSecondsRange{0, 1e7, true};

constexpr std::array kPairSearches = {"grid", "sweep", "brute"};
constexpr std::array kTargets = {SimdTarget::kBest, SimdTarget::kScalar, SimdTarget::kSse4,
                                 SimdTarget::kAvx2, SimdTarget::kAvx512};

void read_culling(const Fields& fields, StudyOptions& options) {
  CullerOptions& culler = options.culler;
  if (fields.find("deadline_tests") != nullptr)
    culler.deadline_tests =
        static_cast<uint64_t>(fields.integer_or("deadline_tests", 0, INT64_MAX, 0));
  options.strategy =
      kind_at<Strategy>(fields, "strategy", kAllStrategies).value_or(Strategy::kPipeline);
  if (options.strategy != Strategy::kPipeline) {
    culler.pair_search = PairSearch::kBrute;
    if (culler.deadline_tests)
      throw InputError(fields.where(*fields.find("deadline_tests")),
                       "no deadline_tests beside a strategy of the paper", "both");
  }
  culler.simd = resolved(kind_at<SimdTarget>(fields, "simd", kTargets).value_or(SimdTarget::kBest));
  const std::vector<std::string> searches(kPairSearches.begin(), kPairSearches.end());
  if (const auto found = fields.word("pair_search", searches))
    culler.pair_search = static_cast<PairSearch>(*found);
}

}  // namespace

const std::vector<std::string>& study_option_names() {
  static const std::vector<std::string> names = {"avatars",        "seconds", "steering",
                                                 "part_volume",    "exact",   "strategy",
                                                 "deadline_tests", "simd",    "pair_search"};
  return names;
}

std::string why_no_study_option(const std::string& name) {
  if (name == "deadline_ms")
    return "what comes out the same every time ('deadline_tests' does; a clock does not)";
  if (name == "threads") return "threads on the command line: throng study FILE --threads N";
  if (name == "seed") return "'seeds: [1, 2, 3]'";
  constexpr std::array kOutputs = {"log",           "lcm",   "json",       "trajectory", "html",
                                   "contacts",      "pace",  "flush_s",    "states_hz",  "every",
                                   "publish_parts", "trace", "checkpoint", "resume"};
  if (std::find(kOutputs.begin(), kOutputs.end(), name) != kOutputs.end())
    return "an option that shapes a result (what a study finds goes to its table)";
  return "";
}

StudyOptions read_study_options(const Fields& fields) {
  fields.expect_keys(study_option_names());
  StudyOptions options;
  RunChoices& choices = options.choices;
  if (fields.find("avatars") != nullptr)
    choices.avatars = static_cast<int>(fields.integer_or("avatars", 1, PairKey::kMaxId, 1));
  if (fields.find("seconds") != nullptr) choices.seconds = fields.number("seconds", kSecondsRange);
  choices.steering = kind_at<SteeringKind>(fields, "steering", all_steering_kinds());
  choices.part_volume = kind_at<VolumeKind>(fields, "part_volume", kAllVolumes);
  choices.exact = fields.boolean_or("exact", false);
  read_culling(fields, options);
  return options;
}

}  // namespace throng
