#include "recordings/people_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr double kSmallest_m = 1.0, kTallest_m = 2.3;  ///< people
constexpr double kSameHeight_m = 1e-6;

}  // namespace

/// The middle one of all heights of the head's top, which neither a stumble nor a wrong measurement
/// moves.
std::optional<double> PeopleSurvey::height_of(std::span<const Sample> samples) {
  heights_m_.clear();
  for (const Sample& sample : samples)
    if (!std::isnan(sample.z_m)) heights_m_.push_back(sample.z_m);
  if (heights_m_.empty()) return std::nullopt;
  const auto [least, most] = std::minmax_element(heights_m_.begin(), heights_m_.end());
  least_z_m_ = std::min(least_z_m_, static_cast<double>(*least));
  most_z_m_ = std::max(most_z_m_, static_cast<double>(*most));
  const auto middle = heights_m_.begin() + static_cast<ptrdiff_t>(heights_m_.size() / 2);
  std::nth_element(heights_m_.begin(), middle, heights_m_.end());
  return static_cast<double>(*middle);
}

void PeopleSurvey::take(int64_t id, std::span<const Sample> samples) {
  if (people_.empty()) bounds_ = {samples[0].position_m, samples[0].position_m};
  people_.push_back({.id = id,
                     .samples = static_cast<int64_t>(samples.size()),
                     .first_s = samples.front().time_s,
                     .last_s = samples.back().time_s,
                     .height_m = height_of(samples)});
  samples_ += people_.back().samples;
  duration_s_ = std::max(duration_s_, samples.back().time_s);
  hash_.add(static_cast<uint64_t>(id));
  for (const Sample& sample : samples) {
    bounds_.min_m = bounds_.min_m.cwiseMin(sample.position_m);
    bounds_.max_m = bounds_.max_m.cwiseMax(sample.position_m);
    hash_.add(sample.time_s).add(sample.position_m.x()).add(sample.position_m.y());
    // One NaN is as good as another.
    for (const float value : {sample.z_m, sample.heading_rad})
      std::isnan(value) ? hash_.add(uint64_t{1}) : hash_.add(static_cast<double>(value));
  }
}

void PeopleSurvey::judge_heights(RecordingFacts& facts) {
  // A z that is the same for all was measured of nobody.
  const bool are_the_same = people_.size() > 1 && most_z_m_ - least_z_m_ <= kSameHeight_m;
  const bool are_heights = facts.tracks == TrackedPoint::kHead && !are_the_same;
  Oddity none{"heads lower than 1.0 m or higher than 2.3 m", 0, {}};
  for (RecordedPerson& person : people_) {
    if (!person.height_m) continue;
    const bool is_one = *person.height_m >= kSmallest_m && *person.height_m <= kTallest_m;
    if (!is_one && none.count++ == 0)
      none.first = fmt::format("id {}: {:.3g} m", person.id, *person.height_m);
    if (!are_heights || !is_one) person.height_m.reset();
    hash_.add(person.height_m.value_or(0));
  }
  // Where all are so, z is something else: the floor, or nothing.
  if (are_heights && none.count > 0 && none.count < static_cast<int64_t>(people_.size()))
    facts.odd.push_back(std::move(none));
}

std::vector<RecordedPerson> PeopleSurvey::finish(RecordingFacts& facts) {
  facts.samples = samples_;
  facts.duration_s = duration_s_;
  facts.bounds = bounds_;
  if (facts.fps > 0) facts.frames = std::llround(facts.duration_s * facts.fps) + 1;
  if (duration_s_ == 0) facts.odd.push_back({"a single frame", 1, "nobody moves"});
  judge_heights(facts);
  hash_.add(facts.fps).add(facts.duration_s).add(static_cast<uint64_t>(facts.tracks));
  hash_.add(facts.shift_m.x()).add(facts.shift_m.y());
  hash_.add(std::string_view(facts.wkt)).add(facts.wkt_unit_m);
  return std::move(people_);
}

}  // namespace throng
