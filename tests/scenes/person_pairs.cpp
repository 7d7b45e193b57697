#include "tests/scenes/person_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "culling/triangles/triangle_test.h"
#include "scenes/run/postures.h"
#include "scenes/run/sink.h"

namespace throng::test {
namespace {

constexpr float kMargin_m = 0.01f;

}  // namespace

float PersonPairs::Box::gap_m(const Box& other, const Eigen::Vector3f& shift_m) const {
  return (other.low + shift_m - high).cwiseMax(low - other.high - shift_m).maxCoeff();
}

PersonPairs::PersonPairs(const Simulation& run, float proximity_m)
    : run_(run), margin_m_(proximity_m), reach_m_(proximity_m + kMargin_m) {
  for (const auto& model : run.info().models) {
    surfaces_.emplace_back();
    trees_.emplace_back();
    for (const Part& part : model->parts) {
      surfaces_.back().emplace_back(part.mesh.vertices, part.mesh.triangles);
      if (proximity_m > 0) trees_.back().emplace_back(part.mesh.vertices, part.mesh.triangles);
    }
  }
}

void PersonPairs::place(const Frame& frame, uint32_t id) {
  const uint16_t type = run_.bodies().types[id];
  const Model& model = *run_.info().models[type];
  const float scale = run_.bodies().scales[id];
  Avatar& avatar = avatars_[id];
  avatar.poses.resize(model.parts.size());
  avatar.boxes.clear();
  part_poses(run_.info(), frame, id, avatar.poses);
  constexpr float kMax = std::numeric_limits<float>::max();
  const Box none = {Eigen::Vector3f::Constant(kMax), Eigen::Vector3f::Constant(-kMax)};
  avatar.all = none;
  for (size_t i = 0; i < model.parts.size(); ++i) {
    Box box = none;
    const Eigen::Isometry3f frame_of_part = to_isometry(avatar.poses[i]).cast<float>();
    for (const Eigen::Vector3f& vertex : model.parts[i].mesh.vertices) {
      const Eigen::Vector3f at = frame_of_part * (scale * vertex);
      box.low = box.low.cwiseMin(at);
      box.high = box.high.cwiseMax(at);
    }
    avatar.all.low = avatar.all.low.cwiseMin(box.low);
    avatar.all.high = avatar.all.high.cwiseMax(box.high);
    avatar.boxes.push_back(box);
  }
}

bool PersonPairs::touch(uint32_t a, uint32_t i, uint32_t b, uint32_t j,
                        const Eigen::Vector3f& a_to_b) {
  const BodyStates& bodies = run_.bodies();
  TriangleCounters counters;
  return solids_touch(surfaces_[bodies.types[a]][i], avatars_[a].poses[i], bodies.scales[a],
                      surfaces_[bodies.types[b]][j], avatars_[b].poses[j], bodies.scales[b], a_to_b,
                      counters);
}

void PersonPairs::compare(const Frame& frame, uint32_t a, uint32_t b) {
  const Eigen::Vector3f a_to_b =
      (frame.roots[b].position_m - frame.roots[a].position_m).cast<float>();
  const Avatar &first = avatars_[a], &second = avatars_[b];
  if (first.all.gap_m(second.all, a_to_b) > reach_m_) return;
  const auto placed = [this](uint32_t id, uint32_t part) -> DistanceTree::Placed {
    return {&trees_[run_.bodies().types[id]][part], &avatars_[id].poses[part],
            run_.bodies().scales[id]};
  };
  ProximityOracle judge(margin_m_, rows);
  for (uint32_t i = 0; i < first.boxes.size(); ++i)
    for (uint32_t j = 0; j < second.boxes.size(); ++j) {
      const float gap_m = first.boxes[i].gap_m(second.boxes[j], a_to_b);
      if (gap_m > reach_m_) continue;
      const bool is_near = gap_m <= kMargin_m, touches = is_near && touch(a, i, b, j, a_to_b);
      const PairKey key(a, b, i, j);
      const auto describe = [&] {
        return fmt::format("{:.3f} s: avatars {} and {}, parts {} and {}",
                           1e-6 * static_cast<double>(frame.utime_us), a, b, i, j);
      };
      tested += is_near;
      touching += touches;
      if (margin_m_ > 0)
        judge.judge(placed(a, i), placed(b, j), a_to_b.cast<double>(), touches, key,
                    frame.proximity_pairs, describe);
      if (!touches || std::binary_search(frame.pairs.begin(), frame.pairs.end(), key)) continue;
      if (missed++ == 0) first_miss = describe();
    }
}

void PersonPairs::check(const Frame& frame) {
  const auto people = static_cast<uint32_t>(frame.roots.size());
  avatars_.resize(people);
  const auto is_there = [&frame](uint32_t id) {
    return frame.present.empty() || frame.present[id] != 0;
  };
  std::vector<uint32_t> order;
  for (uint32_t id = 0; id < people; ++id) {
    if (!is_there(id)) continue;
    place(frame, id);
    order.push_back(id);
  }
  const auto x_of = [&](uint32_t id) { return frame.roots[id].position_m.x(); };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return x_of(a) < x_of(b); });
  // Maximum distance between the centres of people in contact.
  const double reach_m = 3 + static_cast<double>(margin_m_);
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size() && x_of(order[j]) - x_of(order[i]) < reach_m; ++j)
      compare(frame, std::min(order[i], order[j]), std::max(order[i], order[j]));
}

}  // namespace throng::test
