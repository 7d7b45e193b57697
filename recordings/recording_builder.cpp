#include "recordings/recording_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/checksum.h"
#include "base/errors.h"
#include "culling/pair.h"
#include "geometry/polygon.h"
#include "geometry/polygon_union.h"
#include "recordings/recorded_samples.h"
#include "recordings/recording.h"
#include "recordings/time_grid.h"

namespace throng {

// TrackCheck counts anomalies of tracks and describes the first of each kind. It repairs and
// rejects nothing.

class PolygonLocator;

/// Text for an instant: "frame 112", "12.48 s".
using InstantName = std::function<std::string(double time_s)>;

class TrackCheck {
 public:
  /// `fps`: rate of recorded frames, 0 for events. `area`: null if the file has none.
  TrackCheck(double fps, const PolygonLocator* area, InstantName name)
      : fps_(fps), area_(area), name_(std::move(name)) {}

  void take(int64_t id, std::span<const Sample> samples, const Duplicates& duplicates);
  /// Anomalies so far, the most severe first.
  std::vector<Anomaly> found() const;

 private:
  enum Kind { kJump, kFast, kReappears, kGap, kDuplicate, kOutside, kSingle, kKinds };
  struct Count {
    int64_t count = 0;
    std::string first;
  };

  void check_step(int64_t id, const Sample& from, const Sample& to, double usual_s);
  double usual_interval_s(std::span<const Sample> samples);
  /// Counts an anomaly; returns true for the first, which needs a description.
  bool is_first(Kind kind, int64_t times = 1) {
    counts_[kind].count += times;
    return counts_[kind].count == times;
  }

  double fps_;
  const PolygonLocator* area_;
  InstantName name_;
  std::array<Count, kKinds> counts_;
  std::vector<double> gaps_s_;
};

// PeopleSurvey derives presence, heights and bounds of people from their complete samples. It sees
// each person once, in ascending order of ids, and stores no samples.

class PeopleSurvey {
 public:
  void take(int64_t id, std::span<const Sample> samples);
  /// Returns the people and completes the facts. Call it once.
  std::vector<RecordedPerson> finish(RecordingFacts& facts);
  uint64_t hash() const { return hash_.value(); }

 private:
  std::optional<double> height_of(std::span<const Sample> samples);
  void check_heights(RecordingFacts& facts);

  std::vector<RecordedPerson> people_;
  int64_t samples_ = 0;
  double duration_s_ = 0;
  Rectangle bounds_;
  double min_z_m_ = std::numeric_limits<double>::infinity();
  double max_z_m_ = -std::numeric_limits<double>::infinity();
  std::vector<float> heights_m_;
  Hasher hash_;
};

namespace {

/// Larger values are not coordinates of any map on Earth.
constexpr double kMaxCoordinate_m = 1e8;
/// Doubles represent whole numbers up to about this value.
constexpr double kMaxFrame = 9e15;
constexpr double kMaxTime_s = 1e12;
constexpr double kMaxDuration_s = 1e7;
constexpr double kMaxExtent_m = 10'000;
/// Larger coordinates are map coordinates.
constexpr double kNoMap_m = 10'000;
constexpr int64_t kDirectIds = 1 << 16;
/// Maximum difference between the end of a step and the start of the next.
constexpr double kSameEvent_s = 1e-6;

constexpr double kMinHeight_m = 1.0, kMaxHeight_m = 2.3;
constexpr double kSameHeight_m = 1e-6;

/// Top speed of sprinters; people in crowds are slower.
constexpr double kMaxSpeed_mps = 12;
/// Longer displacements are probably continued tracks of other people.
constexpr double kJump_m = 3;
/// A person not visible for longer has left and returned.
constexpr double kMaxAbsence_s = 1;
/// Longer intervals, relative to the usual one, lack samples.
constexpr double kGapFactor = 1.5;
/// People who move less between footsteps stand still, for any time.
constexpr double kMoved_m = 0.01;

}  // namespace

RecordingBuilder::RecordingBuilder(const RecordingOptions& options)
    : options_(options), store_(std::make_unique<SampleStore>()), small_ids_(kDirectIds, 0) {}

RecordingBuilder::~RecordingBuilder() = default;

std::string RecordingBuilder::where(int64_t place) const {
  if (place <= 0) return options_.file.string();
  if (header_.place == "line") return fmt::format("{}:{}", options_.file.string(), place);
  return fmt::format("{}: {} {}", options_.file.string(), header_.place, place);
}

void RecordingBuilder::reject(int64_t place, std::string_view expected,
                              std::string_view found) const {
  throw InputError(where(place), expected, found);
}

void RecordingBuilder::note(std::string what, int64_t count, std::string first) {
  anomalies_.push_back({std::move(what), count, std::move(first)});
}

size_t RecordingBuilder::person_of(int64_t id, int64_t place) {
  if (id == last_id_) return last_person_;
  uint32_t& number = id < kDirectIds ? small_ids_[static_cast<size_t>(id)] : large_ids_[id];
  if (number == 0) {
    if (ids_.size() > PairKey::kMaxId)
      reject(place, fmt::format("at most {} people", PairKey::kMaxId + 1), "more");
    ids_.push_back(id);
    number = static_cast<uint32_t>(store_->add_person()) + 1;
  }
  last_id_ = id;
  last_person_ = number - 1;
  return last_person_;
}

void RecordingBuilder::extend_bounds(const StoredSample& sample, int64_t place) {
  const bool is_first = ids_.size() == 1 && store_->count(0) == 0;
  const double xy[2] = {sample.x_m, sample.y_m};
  for (int axis = 0; axis < 2; ++axis) {
    if (is_first || xy[axis] < min_[axis].value) min_[axis] = {xy[axis], place};
    if (is_first || xy[axis] > max_[axis].value) max_[axis] = {xy[axis], place};
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
  if (id < 0) reject(place, "an id of 0 or more", std::to_string(id));
  // Negated comparison: also rejects NaN.
  if (!(std::abs(sample.instant) <= (has_frames() ? kMaxFrame : kMaxTime_s)))
    reject(place, has_frames() ? "a frame within 9e15" : "a time within 1e12 s",
           fmt::format("{}", sample.instant));
  if (std::isnan(sample.x_m) || std::isnan(sample.y_m)) return add_gap(id, sample.instant);
  if (!(std::abs(sample.x_m) <= kMaxCoordinate_m && std::abs(sample.y_m) <= kMaxCoordinate_m))
    reject(place, "x and y within 1e8 m", fmt::format("({}, {})", sample.x_m, sample.y_m));
  const size_t person = person_of(id, place);
  extend_bounds(sample, place);
  has_headings_ |= !std::isnan(sample.heading_rad);
  store_->add(person, sample);
}

Eigen::Vector2d RecordingBuilder::shift() const {
  Eigen::Vector2d out = Eigen::Vector2d::Zero();
  const double far = std::max({-min_[0].value, max_[0].value, -min_[1].value, max_[1].value});
  if (far <= kNoMap_m) return out;
  for (int axis = 0; axis < 2; ++axis)
    out[axis] = 1000 * std::floor(0.5 * (min_[axis].value + max_[axis].value) / 1000);
  return out;
}

void RecordingBuilder::check_extent() const {
  for (int axis = 0; axis < 2; ++axis) {
    const Extreme& min = min_[axis];
    const Extreme& max = max_[axis];
    if (max.value - min.value <= 2 * kMaxExtent_m) continue;
    // The extreme that occurs later in the file is more likely to be wrong.
    const Extreme& outlier = std::max(min.place, max.place) == max.place ? max : min;
    reject(outlier.place,
           fmt::format("{} within 10 km of the middle of all (--unit is for files that "
                       "are not in metres)",
                       axis == 0 ? "x" : "y"),
           fmt::format("{} m, and {} m elsewhere", outlier.value,
                       (&outlier == &max ? min : max).value));
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
                   fmt::format("times of {:g} frames per second (--fps)", *options_.fps),
                   "other times; omit --fps to use those of the file");
}

SampleMapping RecordingBuilder::mapping(RecordingFacts& facts) {
  SampleMapping out;
  const auto check_step = static_cast<double>(std::max<int64_t>(step_, 1));
  switch (header_.clock) {
    case RecordedClock::kFrames:
      out.per_s = header_.per_s;
      facts.fps = header_.per_s / check_step;
      break;
    case RecordedClock::kSteps:
      out.per_s = header_.per_s * check_step;
      facts.fps = header_.per_s;
      break;
    case RecordedClock::kTimes: {
      const PrintedTimes times{first_instant_, header_.rounding_s};
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
  if (last_instant_ - first_instant_ > kMaxDuration_s * out.per_s)
    throw InputError(options_.file.string(), "a recording of at most 1e7 s",
                     fmt::format("one of {:.4g} s", (last_instant_ - first_instant_) / out.per_s));
  // Requested range of times, with a tolerance at both ends.
  const double slack_s = facts.fps > 0 ? 0.01 / facts.fps : kSameEvent_s;
  const double max_instant = first_instant_ + (options_.end_s + slack_s) * out.per_s;
  out.last = max_instant;
  if (options_.start_s > 0) {
    out.first = first_instant_ + (options_.start_s - slack_s) * out.per_s;
    const double first = first_instant_from(out.first);
    if (!std::isfinite(first) || first > out.last)
      throw InputError(
          options_.file.string(),
          fmt::format("a person between {} s and {} s", options_.start_s, options_.end_s),
          fmt::format("a recording of {:.6g} s", (last_instant_ - first_instant_) / out.per_s));
    out.origin = first;
    if (out.grid_per_s > 0)
      out.origin =
          first_instant_ + std::round((first - first_instant_) * out.grid_per_s) / out.grid_per_s;
  }
  if (has_frames()) facts.frame_step = std::max<int64_t>(step_, 1);
  return out;
}

std::optional<PolygonLocator> RecordingBuilder::area(const RecordingFacts& facts) {
  if (facts.wkt.empty()) return std::nullopt;
  const JoinedArea area = recorded_area(facts, options_.file.string());
  if (area.gaps > 0)
    note("gaps of up to 1 mm in the walkable area (closed)", area.gaps,
         fmt::format("{:.2g} mm wide at ({:.3f}, {:.3f}) m", 1e3 * area.max_gap_m,
                     area.max_gap_at_m.x(), area.max_gap_at_m.y()));
  return std::optional<PolygonLocator>(std::in_place, area.polygons);
}

RecordingFacts RecordingBuilder::stated_facts() const {
  RecordingFacts facts;
  facts.kind = header_.kind;
  facts.tracked_point = options_.tracked_point.value_or(header_.tracked_point);
  facts.has_headings = has_headings_;
  facts.wkt = header_.wkt;
  facts.wkt_unit_m = header_.wkt_unit_m;
  facts.shift_m = shift();
  return facts;
}

void RecordingBuilder::compare_rates() {
  constexpr double kAllowed = 0.02;
  std::optional<double> found = frame_times_.per_s();
  double allowed = kAllowed;
  if (found) {
    allowed += frame_times_.uncertainty();
  } else if (header_.clock == RecordedClock::kTimes && times_per_s_) {
    found = times_per_s_;
    allowed += 2 * header_.rounding_s / (last_instant_ - first_instant_);
  }
  if (stated_per_s_ <= 0 || !found) return;
  if (std::abs(*found - stated_per_s_) <= allowed * *found) return;
  const bool takes_times = header_.clock == RecordedClock::kTimes && !options_.fps;
  note("a frame rate that contradicts the times of the file", 1,
       fmt::format("{:g} per second of {}, {:.6g} of the times; {} is used", stated_per_s_,
                   stated_by_, *found,
                   takes_times ? "that of the times" : fmt::format("{:g}", stated_per_s_)));
}

void RecordingBuilder::reject_anomalies(const std::vector<Anomaly>& anomalies) const {
  if (!options_.strict || anomalies.empty()) return;
  const Anomaly& first = anomalies.front();
  throw InputError(
      options_.file.string(), "no anomalies (--strict)",
      fmt::format(
          "{} ({}), first {}{}", first.what, first.count, first.first,
          anomalies.size() > 1 ? fmt::format("; {} more kinds", anomalies.size() - 1) : ""));
}

std::shared_ptr<const Recording> RecordingBuilder::finish() {
  if (ids_.empty())
    throw InputError(options_.file.string(), "at least one position of a person",
                     gaps_ > 0 ? fmt::format("only {} missing ones", gaps_) : "none");
  if (gaps_ > 0) note("missing positions (gaps in tracks)", gaps_, first_gap_);
  if (empty_rows_ > 0)
    note("rows with separators only (treated as empty lines)", empty_rows_,
         fmt::format("{} {}", header_.place, first_empty_row_));
  store_->finish();
  small_ids_ = {};
  large_ids_ = {};
  check_extent();
  RecordingFacts facts = stated_facts();
  SampleMapping mapping = this->mapping(facts);
  mapping.shift_m = facts.shift_m;
  compare_rates();
  if (has_frames()) facts.first_frame = static_cast<int64_t>(mapping.origin);
  auto samples = std::make_unique<RecordedSamples>(std::move(store_), mapping);

  const std::optional<PolygonLocator> area = this->area(facts);
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
    throw InputError(options_.file.string(), fmt::format("a person before {} s", options_.end_s),
                     "none");
  facts.anomalies = check.found();
  facts.anomalies.insert(facts.anomalies.end(), anomalies_.begin(), anomalies_.end());
  std::vector<RecordedPerson> people = survey.finish(facts);
  reject_anomalies(facts.anomalies);
  samples->order(std::move(kept));
  return std::make_shared<const Recording>(std::move(facts), std::move(people), std::move(samples),
                                           survey.hash());
}

/// Median of the heights of a person, robust against stumbles and measurement errors.
std::optional<double> PeopleSurvey::height_of(std::span<const Sample> samples) {
  heights_m_.clear();
  for (const Sample& sample : samples)
    if (!std::isnan(sample.z_m)) heights_m_.push_back(sample.z_m);
  if (heights_m_.empty()) return std::nullopt;
  const auto [min, max] = std::minmax_element(heights_m_.begin(), heights_m_.end());
  min_z_m_ = std::min(min_z_m_, static_cast<double>(*min));
  max_z_m_ = std::max(max_z_m_, static_cast<double>(*max));
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
    // All NaNs hash equally.
    for (const float value : {sample.z_m, sample.heading_rad})
      std::isnan(value) ? hash_.add(uint64_t{1}) : hash_.add(static_cast<double>(value));
  }
}

void PeopleSurvey::check_heights(RecordingFacts& facts) {
  // A z that is equal for all people is no measured height.
  const bool are_the_same = people_.size() > 1 && max_z_m_ - min_z_m_ <= kSameHeight_m;
  const bool are_heights = facts.tracked_point == TrackedPoint::kHead && !are_the_same;
  Anomaly implausible{"heads lower than 1.0 m or higher than 2.3 m", 0, {}};
  for (RecordedPerson& person : people_) {
    if (!person.height_m) continue;
    const bool is_plausible = *person.height_m >= kMinHeight_m && *person.height_m <= kMaxHeight_m;
    if (!is_plausible && implausible.count++ == 0)
      implausible.first = fmt::format("id {}: {:.3g} m", person.id, *person.height_m);
    if (!are_heights || !is_plausible) person.height_m.reset();
    hash_.add(person.height_m.value_or(0));
  }
  // If no height is one of a person, z is something else, such as the floor.
  if (are_heights && implausible.count > 0 &&
      implausible.count < static_cast<int64_t>(people_.size()))
    facts.anomalies.push_back(std::move(implausible));
}

std::vector<RecordedPerson> PeopleSurvey::finish(RecordingFacts& facts) {
  facts.samples = samples_;
  facts.duration_s = duration_s_;
  facts.bounds = bounds_;
  if (facts.fps > 0) facts.frames = std::llround(facts.duration_s * facts.fps) + 1;
  if (duration_s_ == 0) facts.anomalies.push_back({"a single frame", 1, "no motion"});
  check_heights(facts);
  hash_.add(facts.fps).add(facts.duration_s).add(static_cast<uint64_t>(facts.tracked_point));
  hash_.add(facts.shift_m.x()).add(facts.shift_m.y());
  hash_.add(std::string_view(facts.wkt)).add(facts.wkt_unit_m);
  return std::move(people_);
}

double TrackCheck::usual_interval_s(std::span<const Sample> samples) {
  gaps_s_.clear();
  for (size_t i = 1; i < samples.size(); ++i)
    gaps_s_.push_back(samples[i].time_s - samples[i - 1].time_s);
  const auto [min, max] = std::minmax_element(gaps_s_.begin(), gaps_s_.end());
  if (*max <= kGapFactor * *min) return *max;
  const auto middle = gaps_s_.begin() + static_cast<ptrdiff_t>((gaps_s_.size() - 1) / 2);
  std::nth_element(gaps_s_.begin(), middle, gaps_s_.end());
  return *middle;
}

void TrackCheck::check_step(int64_t id, const Sample& from, const Sample& to, double usual_s) {
  const double gap_s = to.time_s - from.time_s;
  const double distance_m = (to.position_m - from.position_m).norm();
  const bool lacks_samples = gap_s > kGapFactor * usual_s;
  const bool may_stand = fps_ == 0 && distance_m < kMoved_m;
  if (lacks_samples && gap_s > kMaxAbsence_s && !may_stand) {
    if (is_first(kReappears))
      counts_[kReappears].first =
          fmt::format("id {} at {}, {:.4g} s and {:.3g} m after its last position", id,
                      name_(to.time_s), gap_s, distance_m);
    return;
  }
  if (lacks_samples && !may_stand && is_first(kGap))
    counts_[kGap].first = fps_ > 0 ? fmt::format("id {} at {}: {} frames before it are missing", id,
                                                 name_(to.time_s), std::lround(gap_s * fps_) - 1)
                                   : fmt::format("id {} at {}: {:.3g} s after its last position",
                                                 id, name_(to.time_s), gap_s);
  if (distance_m <= kMaxSpeed_mps * gap_s) return;
  const Kind kind = distance_m > kJump_m ? kJump : kFast;
  if (is_first(kind))
    counts_[kind].first =
        fmt::format("id {} at {}: {:.3g} m in {:.3g} s", id, name_(to.time_s), distance_m, gap_s);
}

void TrackCheck::take(int64_t id, std::span<const Sample> samples, const Duplicates& duplicates) {
  if (samples.empty()) return;
  if (duplicates.count > 0 && is_first(kDuplicate, duplicates.count))
    counts_[kDuplicate].first = fmt::format("id {} at {}", id, name_(duplicates.first_s));
  if (samples.size() == 1) {
    if (is_first(kSingle))
      counts_[kSingle].first = fmt::format("id {} at {}", id, name_(samples[0].time_s));
  } else {
    const double usual_s = usual_interval_s(samples);
    for (size_t i = 1; i < samples.size(); ++i) check_step(id, samples[i - 1], samples[i], usual_s);
  }
  if (area_ == nullptr) return;
  for (const Sample& sample : samples)
    if (!area_->contains(sample.position_m) && is_first(kOutside))
      counts_[kOutside].first =
          fmt::format("id {} at {}: ({:.3f}, {:.3f}) m", id, name_(sample.time_s),
                      sample.position_m.x(), sample.position_m.y());
}

std::vector<Anomaly> TrackCheck::found() const {
  static constexpr const char* kNames[kKinds] = {"jumps of more than 3 m",
                                                 "speeds above 12 m/s",
                                                 "ids that reappear after more than 1 s",
                                                 "gaps in tracks",
                                                 "duplicate positions (the first is used)",
                                                 "positions outside the walkable area",
                                                 "people with a single position"};
  std::vector<Anomaly> out;
  for (size_t kind = 0; kind < kKinds; ++kind)
    if (counts_[kind].count > 0)
      out.push_back({kNames[kind], counts_[kind].count, counts_[kind].first});
  return out;
}

}  // namespace throng
