#include "bench/micro/candidates.h"

#include <algorithm>
#include <numeric>

#include "bench/boxes.h"

namespace throng::bench {

Candidates::Candidates(int avatars, double per_m2) {
  Crowd crowd(load_model(adult_urdf()), {.avatars = avatars, .per_m2 = per_m2});
  for (int step = 0; step < 60; ++step) crowd.advance();
  type_ = crowd.body_type();
  find(crowd);
  sort_into_buckets();
}

void Candidates::find(const Crowd& crowd) {
  CrowdBoxes boxes(crowd, type_);
  const BoxList list = boxes.compute();
  poses_ = boxes.poses();
  const BodiesView bodies = crowd.view();
  const uint16_t first_shape = 0;
  const BucketRule bucket({nullptr, nullptr, &first_shape, list.parts}, 0, 0);
  for (const BoxPair& found : reference_pairs(list)) {
    const uint32_t a = found.a / list.parts, b = found.b / list.parts;
    if (pairs_.empty() || pairs_.back().body_a != a || pairs_.back().body_b != b) {
      const Eigen::Vector3f shift =
          (bodies.roots[b].position_m - bodies.roots[a].position_m).cast<float>();
      const float reach = shift.norm() + 4 * type_->sphere().radius_m;
      pairs_.push_back({{shift.x(), shift.y(), shift.z(), rounding_margin_m(reach)},
                        bodies.scales[a],
                        bodies.scales[b],
                        a * list.parts,
                        b * list.parts,
                        0,
                        0,
                        a,
                        b,
                        0,
                        0});
    }
    const uint32_t part_a = found.a % list.parts, part_b = found.b % list.parts;
    candidates_.push_back({static_cast<uint32_t>(pairs_.size() - 1), static_cast<uint8_t>(part_a),
                           static_cast<uint8_t>(part_b), bucket(part_a, part_b)});
  }
}

void Candidates::sort_into_buckets() {
  const size_t parts = static_cast<size_t>(type_->part_count());
  order_.resize(candidates_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::stable_sort(order_.begin(), order_.end(), [this](uint32_t i, uint32_t j) {
    return candidates_[i].bucket() < candidates_[j].bucket();
  });
  starts_.assign(parts * parts + 1, 0);
  for (const Candidate& c : candidates_) ++starts_[size_t{c.bucket()} + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
}

const Candidates& crowd_candidates() {
  static const Candidates candidates(2000, 4);
  return candidates;
}

}  // namespace throng::bench
