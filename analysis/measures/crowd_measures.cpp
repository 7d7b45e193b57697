#include "analysis/measures/crowd_measures.h"

#include <algorithm>
#include <cmath>

#include "analysis/measures/contact_measures.h"
#include "analysis/measures/motion_measures.h"
#include "analysis/measures/recent_crowd.h"
#include "analysis/measures/speed_and_spacing.h"

namespace throng {
namespace {

constexpr double kSample_s = 0.1;

int64_t frames_between_samples(double step_s) {
  return std::max<int64_t>(1, std::llround(kSample_s / step_s));
}

size_t window(double sample_s) {
  return 2 * std::max(
                 {Velocities::half_window(sample_s), HeadSway::half_window(sample_s), size_t{1}}) +
         1;
}

}  // namespace

struct CrowdMeasures::State {
  State(const RunInfo& run, const MeasureOptions& options)
      : every(frames_between_samples(run.step_s)),
        sample_s(static_cast<double>(every) * run.step_s),
        heads(run),
        crowd(run.model_of_avatar.size(), window(sample_s)),
        motion(*run.scene),
        width(*run.scene),
        sway(run.model_of_avatar.size(), sample_s),
        accelerations(sample_s),
        flow(*run.scene, run.model_of_avatar.size(), options.line),
        contacts(run),
        depths(run),
        was_seen(run.model_of_avatar.size(), 0) {}

  void sample(const RunInfo& run, const Frame& frame);

  int64_t every;
  double sample_s;
  Heads heads;
  RecentCrowd crowd;
  Velocities velocities;
  SpeedAndSpacing motion;
  WidthUse width;
  HeadSway sway;
  Accelerations accelerations;
  FlowLines flow;
  ContactMeasures contacts;
  ContactDepths depths;
  std::vector<uint8_t> was_seen;
  Facts facts;
};

void CrowdMeasures::State::sample(const RunInfo& run, const Frame& frame) {
  Moment& now = crowd.next();
  now.time_s = static_cast<double>(frame.number) * run.step_s;
  heads.find(run, frame, now.heads_m);
  for (size_t id = 0; id < was_seen.size(); ++id) {
    now.roots_m[id] = frame.roots[id].position_m.head<2>();
    now.present[id] = frame.present.empty() || frame.present[id] != 0;
    was_seen[id] |= now.present[id];
    facts.person_s += now.present[id] * sample_s;
  }
  crowd.pushed();
  flow.take(crowd);
  accelerations.take(crowd);
  sway.take(crowd);
  const size_t half = Velocities::half_window(sample_s);
  velocities.find(crowd, half, sample_s);
  motion.take(crowd.ago(half), velocities);
  width.take(crowd.ago(half), velocities);
  depths.find(run, frame, [&](PairKey pair, double depth_m) { contacts.add_depth(pair, depth_m); });
}

CrowdMeasures::CrowdMeasures(const MeasureOptions& options) : options_(options) {}
CrowdMeasures::~CrowdMeasures() = default;

void CrowdMeasures::begin(const RunInfo& run) { state_ = std::make_unique<State>(run, options_); }

void CrowdMeasures::frame(const RunInfo& run, const Frame& frame) {
  state_->contacts.frame(frame);
  if (frame.number % state_->every == 0) state_->sample(run, frame);
  state_->facts.seconds = static_cast<double>(frame.number + 1) * run.step_s;
}

void CrowdMeasures::end(const RunInfo&, const RunEnd&) { state_->contacts.end(); }

std::vector<MeasureTable> CrowdMeasures::tables() const {
  return {state_->motion.speed_table(),
          state_->motion.spacing_table(),
          state_->flow.table(),
          state_->width.table(),
          state_->sway.table(),
          state_->accelerations.table(),
          state_->contacts.contact_table(),
          state_->contacts.depth_table()};
}

CrowdMeasures::Facts CrowdMeasures::facts() const {
  Facts facts = state_->facts;
  facts.sample_s = state_->sample_s;
  facts.people =
      static_cast<size_t>(std::count(state_->was_seen.begin(), state_->was_seen.end(), uint8_t{1}));
  facts.off_area = state_->motion.off_the_area();
  return facts;
}

}  // namespace throng
