#include "culling/stages/pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <functional>

#include "base/errors.h"
#include "base/limits.h"
#include "base/stopwatch.h"

namespace throng {

void PassRun::step(const BodiesView& bodies, const PoseSource& source) {
  assert(bodies.types.size() == bodies.ids.size() && bodies.scales.size() == bodies.ids.size() &&
         bodies.roots.size() == bodies.ids.size());
  assert(std::adjacent_find(bodies.ids.begin(), bodies.ids.end(), std::greater_equal<>()) ==
         bodies.ids.end());
  assert(bodies.ids.empty() || bodies.ids.back() <= PairKey::kMaxId);
  require_scales(bodies.scales);
  const uint64_t grown_before = times_grown();
  Stopwatch whole;
  pass_->run(bodies, source, events_, counters_);
  Stopwatch hashing;
  hash_events();
  counters_.events_ns += hashing.lap_ns();
  counters_.wall_ns = whole.lap_ns();
  counters_.buffers_grown = times_grown() - grown_before;
}

void PassRun::finish() {
  pass_->finish(events_);
  hash_events();
}

void PassRun::hash_events() {
  EventSum sum;
  sum.add(events_.events(), pass_->hash_kind());
  hash_.add_frame(frame_++, sum);
}

void PassRun::archive(Archive& a) {
  uint64_t hash = hash_.value();
  a(frame_, hash);
  hash_ = EventHash(hash);
  const std::span<const PairKey> now = events_.touching();
  std::vector<PairKey> touching(now.begin(), now.end());
  a.resized(touching, SIZE_MAX);
  if (a.is_reading()) {
    if (std::adjacent_find(touching.begin(), touching.end(), std::greater_equal<>()) !=
        touching.end())
      a.reject("sorted pairs", "unsorted pairs");
    for (const PairKey& key : touching)
      if (key.a() >= key.b()) a.reject("pairs of two bodies", "a body with itself");
    events_.resume(touching);
  }
  pass_->archive(a, touching);
}

CullingResult PassRun::frame() const {
  CullingResult frame;
  frame.pairs = events_.touching();
  frame.events = events_.events();
  frame.levels = pass_->levels();
  frame.persisting = events_.persisting();
  frame.counters = &counters_;
  frame.hash = hash();
  return frame;
}

void require_scales(std::span<const float> scales) {
  // Beyond this limit scaled coordinates leave the range of float, and pairs would be lost.
  constexpr auto kMax = static_cast<float>(kMaxDescribed);
  for (size_t i = 0; i < scales.size(); ++i)
    if (!(scales[i] >= 1 / kMax && scales[i] <= kMax))
      throw InputError(fmt::format("scales[{}]", i),
                       fmt::format("a number from {:g} to {:g}", 1 / kMax, kMax),
                       fmt::format("{:g}", scales[i]));
}

void require_triangles(BodyTypes types) {
  for (const auto& type : types)
    if (!type->has_triangles())
      throw InputError("exact contacts", "triangles in every part", "a point cloud");
}

void require_margins(const ProximityOptions& proximity) {
  for (const float margin_m : {proximity.margin_m, proximity.closest_margin_m})
    if (!(margin_m >= 0 && margin_m <= kMaxProximity_m))
      throw InputError("margin", fmt::format("0 to {} m", kMaxProximity_m),
                       fmt::format("{}", margin_m));
}

}  // namespace throng
