#include "recordings/recording_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.h"
#include "culling/pair.h"
#include "recordings/area_union.h"
#include "recordings/people_survey.h"
#include "recordings/time_grid.h"
#include "recordings/track_check.h"
#include "recordings/walkable_wkt.h"

namespace throng {
namespace {

/// Further away is no place on Earth, whichever coordinates a map has.
constexpr double kMostCoordinate_m = 1e8;
/// Doubles count so far.
constexpr double kMostFrame = 9e15;
constexpr double kMostTime_s = 1e12;
constexpr double kLongest_s = 1e7;
/// From the middle of all positions.
constexpr double kWidest_m = 10'000;
/// Coordinates beyond are those of a map.
constexpr double kNoMap_m = 10'000;
constexpr int64_t kDirectIds = 1 << 16;
/// Where a step ends and the next begins.
constexpr double kSameEvent_s = 1e-6;

}  // namespace

RecordingBuilder::RecordingBuilder(const RecordingOptions& options)
    : options_(options), store_(std::make_unique<SampleStore>()), small_ids_(kDirectIds, 0) {}

RecordingBuilder::~RecordingBuilder() = default;

std::string RecordingBuilder::where(int64_t place) const {
  if (place <= 0) return options_.file.string();
  if (head_.place == "line") return fmt::format("{}:{}", options_.file.string(), place);
  return fmt::format("{}: {} {}", options_.file.string(), head_.place, place);
}

void RecordingBuilder::refuse(int64_t place, std::string_view expected,
                              std::string_view found) const {
  throw InputError(where(place), expected, found);
}

void RecordingBuilder::note(std::string what, int64_t count, std::string first) {
  odd_.push_back({std::move(what), count, std::move(first)});
}

size_t RecordingBuilder::person_of(int64_t id, int64_t place) {
  if (id == last_id_) return last_person_;
  uint32_t& number = id < kDirectIds ? small_ids_[static_cast<size_t>(id)] : large_ids_[id];
  if (number == 0) {
    if (ids_.size() > PairKey::kMaxId)
      refuse(place, fmt::format("at most {} people", PairKey::kMaxId + 1), "one more");
    ids_.push_back(id);
    number = static_cast<uint32_t>(store_->add_person()) + 1;
  }
  last_id_ = id;
  last_person_ = number - 1;
  return last_person_;
}

void RecordingBuilder::widen(const StoredSample& sample, int64_t place) {
  const bool is_first = ids_.size() == 1 && store_->count(0) == 0;
  const double xy[2] = {sample.x_m, sample.y_m};
  for (int axis = 0; axis < 2; ++axis) {
    if (is_first || xy[axis] < least_[axis].value) least_[axis] = {xy[axis], place};
    if (is_first || xy[axis] > most_[axis].value) most_[axis] = {xy[axis], place};
  }
  if (is_first) first_instant_ = last_instant_ = sample.instant;
  if (has_frames() && step_ != 1)
    step_ = std::gcd(step_, static_cast<int64_t>(sample.instant - first_instant_));
  first_instant_ = std::min(first_instant_, sample.instant);
  last_instant_ = std::max(last_instant_, sample.instant);
}

void RecordingBuilder::add_gap(int64_t id, double instant) {
  if (gaps_++ > 0) return;
  first_gap_ = has_frames() ? fmt::format("id {} at frame {}", id, std::llround(instant))
                            : fmt::format("id {} at {:.10g} s", id, instant);
}

void RecordingBuilder::state_rate(std::optional<double> per_s, std::string_view by) {
  stated_per_s_ = options_.fps ? *options_.fps : per_s.value_or(0);
  stated_by_ = options_.fps ? "--fps" : by;
}

void RecordingBuilder::skip_empty_row(int64_t place) {
  if (empty_rows_++ == 0) first_empty_row_ = place;
}

void RecordingBuilder::add(int64_t id, const StoredSample& sample, int64_t place) {
  if (id < 0) refuse(place, "an id of 0 or more", std::to_string(id));
  // Written so that NaN is refused.
  if (!(std::abs(sample.instant) <= (has_frames() ? kMostFrame : kMostTime_s)))
    refuse(place, has_frames() ? "a frame within 9e15" : "a time within 1e12 s",
           fmt::format("{}", sample.instant));
  if (std::isnan(sample.x_m) || std::isnan(sample.y_m)) return add_gap(id, sample.instant);
  if (!(std::abs(sample.x_m) <= kMostCoordinate_m && std::abs(sample.y_m) <= kMostCoordinate_m))
    refuse(place, "x and y within 1e8 m", fmt::format("({}, {})", sample.x_m, sample.y_m));
  const size_t person = person_of(id, place);
  widen(sample, place);
  has_headings_ |= !std::isnan(sample.heading_rad);
  store_->add(person, sample);
}

Eigen::Vector2d RecordingBuilder::shift() const {
  Eigen::Vector2d out = Eigen::Vector2d::Zero();
  const double far = std::max({-least_[0].value, most_[0].value, -least_[1].value, most_[1].value});
  if (far <= kNoMap_m) return out;
  for (int axis = 0; axis < 2; ++axis)
    out[axis] = 1000 * std::floor(0.5 * (least_[axis].value + most_[axis].value) / 1000);
  return out;
}

void RecordingBuilder::check_extent() const {
  for (int axis = 0; axis < 2; ++axis) {
    const Extreme& least = least_[axis];
    const Extreme& most = most_[axis];
    if (most.value - least.value <= 2 * kWidest_m) continue;
    // The one further from where the file begins is the likelier to be wrong.
    const Extreme& odd = std::max(least.place, most.place) == most.place ? most : least;
    refuse(
        odd.place,
        fmt::format("{} within 10 km of the middle of all (--unit is for files that "
                    "are not in metres)",
                    axis == 0 ? "x" : "y"),
        fmt::format("{} m, and {} m elsewhere", odd.value, (&odd == &most ? least : most).value));
  }
}

double RecordingBuilder::first_instant_from(double instant) const {
  double first = std::numeric_limits<double>::infinity();
  std::vector<StoredSample> samples;
  for (size_t person = 0; person < store_->people(); ++person) {
    store_->read(person, samples);
    const auto it = std::lower_bound(
        samples.begin(), samples.end(), instant,
        [](const StoredSample& sample, double bound) { return sample.instant < bound; });
    if (it != samples.end()) first = std::min(first, it->instant);
  }
  return first;
}

double RecordingBuilder::given_rate(const PrintedTimes& times) const {
  if (lie_on(*store_, times, *options_.fps)) return *options_.fps;
  throw InputError(options_.file.string(),
                   fmt::format("times of {:g} frames a second, because of --fps", *options_.fps),
                   "others; without --fps the file's own are taken");
}

SampleMapping RecordingBuilder::mapping(RecordingFacts& facts) {
  SampleMapping out;
  const auto step = static_cast<double>(std::max<int64_t>(step_, 1));
  switch (head_.clock) {
    case RecordedClock::kFrames:
      out.per_s = head_.per_s;
      facts.fps = head_.per_s / step;
      break;
    case RecordedClock::kSteps:
      out.per_s = head_.per_s * step;
      facts.fps = head_.per_s;
      break;
    case RecordedClock::kTimes: {
      const PrintedTimes times{first_instant_, head_.rounding_s};
      times_per_s_ = regular_rate(*store_, times);
      facts.fps = options_.fps ? given_rate(times) : times_per_s_.value_or(0);
      if (!times_per_s_ && stated_per_s_ > 0) times_per_s_ = usual_rate(*store_);
      out.grid_per_s = facts.fps;
      break;
    }
    case RecordedClock::kEvents:
      break;
  }
  if (facts.fps == 0) out.same_within_s = kSameEvent_s;
  out.origin = first_instant_;
  if (last_instant_ - first_instant_ > kLongest_s * out.per_s)
    throw InputError(options_.file.string(), "a recording of at most 1e7 s",
                     fmt::format("one of {:.4g} s", (last_instant_ - first_instant_) / out.per_s));
  // A part of the time, with room for rounding at both ends.
  const double slack_s = facts.fps > 0 ? 0.01 / facts.fps : kSameEvent_s;
  const double most_instant = first_instant_ + (options_.until_s + slack_s) * out.per_s;
  out.last = most_instant;
  if (options_.from_s > 0) {
    out.first = first_instant_ + (options_.from_s - slack_s) * out.per_s;
    const double first = first_instant_from(out.first);
    if (!std::isfinite(first) || first > out.last)
      throw InputError(
          options_.file.string(),
          fmt::format("somebody from {} s to {} s", options_.from_s, options_.until_s),
          fmt::format("a recording of {:.6g} s", (last_instant_ - first_instant_) / out.per_s));
    // Frames of a part are on the grid of the whole.
    out.origin = first;
    if (out.grid_per_s > 0)
      out.origin =
          first_instant_ + std::round((first - first_instant_) * out.grid_per_s) / out.grid_per_s;
  }
  if (has_frames()) facts.frame_step = std::max<int64_t>(step_, 1);
  return out;
}

std::optional<WalkableArea> RecordingBuilder::area(const RecordingFacts& facts) {
  if (facts.wkt.empty()) return std::nullopt;
  const JoinedArea area = recorded_area(facts, options_.file.string());
  if (area.gaps > 0)
    note("gaps of up to 1 mm in the walkable area, which are closed", area.gaps,
         fmt::format("{:.2g} mm wide at ({:.3f}, {:.3f}) m", 1e3 * area.widest_m,
                     area.widest_at_m.x(), area.widest_at_m.y()));
  return std::optional<WalkableArea>(std::in_place, area.polygons);
}

RecordingFacts RecordingBuilder::what_is_said() const {
  RecordingFacts facts;
  facts.kind = head_.kind;
  facts.tracks = options_.tracks.value_or(head_.tracks);
  facts.has_headings = has_headings_;
  facts.wkt = head_.wkt;
  facts.wkt_unit_m = head_.wkt_unit_m;
  facts.shift_m = shift();
  return facts;
}

void RecordingBuilder::compare_rates() {
  constexpr double kAllowed = 0.02;
  std::optional<double> found = frame_times_.per_s();
  double allowed = kAllowed;
  if (found) {
    allowed += frame_times_.uncertainty();
  } else if (head_.clock == RecordedClock::kTimes && times_per_s_) {
    found = times_per_s_;
    allowed += 2 * head_.rounding_s / (last_instant_ - first_instant_);
  }
  if (stated_per_s_ <= 0 || !found) return;
  if (std::abs(*found - stated_per_s_) <= allowed * *found) return;
  const bool takes_times = head_.clock == RecordedClock::kTimes && !options_.fps;
  note("a frame rate that the times of the file contradict", 1,
       fmt::format("{:g} a second of {}, {:.6g} of the times; {} was taken", stated_per_s_,
                   stated_by_, *found,
                   takes_times ? "that of the times" : fmt::format("{:g}", stated_per_s_)));
}

void RecordingBuilder::be_strict(const std::vector<Oddity>& odd) const {
  if (!options_.strict || odd.empty()) return;
  const Oddity& first = odd.front();
  throw InputError(
      options_.file.string(), "nothing odd, because of --strict",
      fmt::format("{} ({}), first {}{}", first.what, first.count, first.first,
                  odd.size() > 1 ? fmt::format("; and {} more kinds", odd.size() - 1) : ""));
}

std::shared_ptr<const Recording> RecordingBuilder::finish() {
  if (ids_.empty())
    throw InputError(options_.file.string(), "at least one position of somebody",
                     gaps_ > 0 ? fmt::format("{} missing ones alone", gaps_) : "none");
  if (gaps_ > 0) note("missing positions (gaps of their tracks)", gaps_, first_gap_);
  if (empty_rows_ > 0)
    note("rows of separators alone (taken as empty lines)", empty_rows_,
         fmt::format("{} {}", head_.place, first_empty_row_));
  store_->finish();
  small_ids_ = {};
  large_ids_ = {};
  check_extent();
  RecordingFacts facts = what_is_said();
  SampleMapping mapping = this->mapping(facts);
  mapping.shift_m = facts.shift_m;
  compare_rates();
  if (has_frames()) facts.first_frame = static_cast<int64_t>(mapping.origin);
  auto samples = std::make_unique<RecordedSamples>(std::move(store_), mapping);

  const std::optional<WalkableArea> area = this->area(facts);
  TrackCheck check(facts.fps, area ? &*area : nullptr, [&](double time_s) {
    const double instant = mapping.origin + time_s * mapping.per_s;
    return has_frames() ? fmt::format("frame {}", std::llround(instant))
                        : fmt::format("{:.10g} s", std::round(instant * 1e6) / 1e6);
  });
  PeopleSurvey survey;
  std::vector<uint32_t> order(ids_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return ids_[a] < ids_[b]; });
  std::vector<uint32_t> kept;
  std::vector<Sample> track;
  for (const uint32_t person : order) {
    const Duplicates duplicates = samples->read_stored(person, track);
    if (track.empty()) continue;
    kept.push_back(person);
    survey.take(ids_[person], track);
    check.take(ids_[person], track, duplicates);
  }
  if (kept.empty())
    throw InputError(options_.file.string(), fmt::format("somebody before {} s", options_.until_s),
                     "nobody");
  facts.odd = check.found();
  facts.odd.insert(facts.odd.end(), odd_.begin(), odd_.end());
  std::vector<RecordedPerson> people = survey.finish(facts);
  be_strict(facts.odd);
  samples->order(std::move(kept));
  return std::make_shared<const Recording>(std::move(facts), std::move(people), std::move(samples),
                                           survey.hash());
}

}  // namespace throng
