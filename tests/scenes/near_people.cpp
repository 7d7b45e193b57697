#include "tests/scenes/near_people.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "culling/exact/triangle_test.h"
#include "scenes/run/frame_poses.h"
#include "scenes/run/postures.h"

namespace throng::test {
namespace {

constexpr float kNear_m = 0.01f;

}  // namespace

bool NearPeople::Box::is_near(const Box& other, const Eigen::Vector3f& shift_m) const {
  const Eigen::Vector3f gap = (other.low + shift_m - high).cwiseMax(low - other.high - shift_m);
  return gap.maxCoeff() <= kNear_m;
}

NearPeople::NearPeople(const Simulation& run) : run_(run) {
  for (const auto& model : run.info().models) {
    surfaces_.emplace_back();
    for (const Part& part : model->parts)
      surfaces_.back().emplace_back(part.mesh.vertices, part.mesh.triangles);
  }
}

void NearPeople::place(const Frame& frame, uint32_t id) {
  const uint16_t type = run_.bodies().types[id];
  const Model& model = *run_.info().models[type];
  const float scale = run_.bodies().scales[id];
  Avatar& avatar = avatars_[id];
  avatar.poses.resize(model.parts.size());
  avatar.boxes.clear();
  part_poses(run_.info(), frame, id, avatar.poses);
  constexpr float kMost = std::numeric_limits<float>::max();
  const Box none = {Eigen::Vector3f::Constant(kMost), Eigen::Vector3f::Constant(-kMost)};
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

void NearPeople::compare(const Frame& frame, uint32_t a, uint32_t b) {
  const Eigen::Vector3f a_to_b =
      (frame.roots[b].position_m - frame.roots[a].position_m).cast<float>();
  const Avatar &first = avatars_[a], &second = avatars_[b];
  if (!first.all.is_near(second.all, a_to_b)) return;
  const std::vector<float>& scales = run_.bodies().scales;
  ExactCounters counters;
  for (uint32_t i = 0; i < first.boxes.size(); ++i)
    for (uint32_t j = 0; j < second.boxes.size(); ++j) {
      if (!first.boxes[i].is_near(second.boxes[j], a_to_b)) continue;
      ++near;
      if (!solids_touch(surfaces_[run_.bodies().types[a]][i], first.poses[i], scales[a],
                        surfaces_[run_.bodies().types[b]][j], second.poses[j], scales[b], a_to_b,
                        counters))
        continue;
      ++touching;
      if (std::binary_search(frame.pairs.begin(), frame.pairs.end(), PairKey(a, b, i, j))) continue;
      if (missed++ == 0)
        first_miss = fmt::format("{:.3f} s: avatars {} and {}, parts {} and {}",
                                 1e-6 * static_cast<double>(frame.utime_us), a, b, i, j);
    }
}

void NearPeople::check(const Frame& frame) {
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
  // Nobody reaches farther than this with another.
  constexpr double kReach_m = 3;
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size() && x_of(order[j]) - x_of(order[i]) < kReach_m; ++j)
      compare(frame, std::min(order[i], order[j]), std::max(order[i], order[j]));
}

}  // namespace throng::test
