#include "lcm_io/codec/counter_rows.h"

#include <iterator>

#include "scenes/run/stages.h"

namespace throng {

void fill_stages(stages_t& m, const Frame& frame, bool clock) {
  const auto counted = culling_stages(*frame.counters);
  m.culling_count = static_cast<int32_t>(counted.size());
  for (auto* column : {&m.updates, &m.tests, &m.passed}) column->resize(counted.size());
  for (auto* column : {&m.update_ns, &m.test_ns}) column->resize(counted.size());
  for (size_t i = 0; i < counted.size(); ++i) {
    m.updates[i] = static_cast<int64_t>(counted[i]->updates);
    m.tests[i] = static_cast<int64_t>(counted[i]->tests);
    m.passed[i] = static_cast<int64_t>(counted[i]->passed);
    m.update_ns[i] = clock ? counted[i]->update_ns : 0;
    m.test_ns[i] = clock ? counted[i]->test_ns : 0;
  }
  m.stage_count = static_cast<int32_t>(kStageCount);
  m.stage_ns.assign(kStageCount, 0);
  if (clock && frame.times)
    m.stage_ns.assign(frame.times->stage_ns.begin(), frame.times->stage_ns.end());
}

void fill_counters(counters_t& m, const Frame& frame, int64_t begins, bool clock) {
  const CullingCounters& c = *frame.counters;
  // The four that the type has had from its beginning; stages_t has all.
  const StageCounters* stages[] = {&c.avatar, &c.box, &c.part, &c.exact};
  for (size_t i = 0; i < std::size(stages); ++i) {
    m.updates[i] = static_cast<int64_t>(stages[i]->updates);
    m.tests[i] = static_cast<int64_t>(stages[i]->tests);
    m.passed[i] = static_cast<int64_t>(stages[i]->passed);
    m.update_ns[i] = clock ? stages[i]->update_ns : 0;
    m.test_ns[i] = clock ? stages[i]->test_ns : 0;
  }
  m.posed_bodies = static_cast<int64_t>(c.posed_bodies);
  m.begins = begins;
  m.ends = static_cast<int64_t>(frame.events.size()) - begins;
  m.persisting = static_cast<int64_t>(frame.persisting);
  m.touching = static_cast<int64_t>(frame.pairs.size());
  const FrameTimes times = clock && frame.times ? *frame.times : FrameTimes{};
  m.steering_ns = times[Stage::kSteering];
  m.gait_ns = times[Stage::kGait];
  m.kinematics_ns = times[Stage::kKinematics];
  m.avatar_cull_ns = times[Stage::kAvatarCull];
  m.part_cull_ns = times[Stage::kPartCull];
  m.exact_ns = times[Stage::kExact];
  m.events_ns = times[Stage::kEvents];
  m.publish_ns = times[Stage::kPublish];
  m.frame_ns = times.frame_ns;
}

}  // namespace throng
