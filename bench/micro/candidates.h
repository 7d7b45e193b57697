// The candidates of one frame of the bench crowd: parts of different people whose boxes overlap,
// with all that the part tests need. One rule: the real mix in the real order, so that no branch is
// learned from a short list.
#pragma once

#include <memory>
#include <vector>

#include "bench/crowd.h"
#include "culling/fitted.h"

namespace throng::bench {

class Candidates {
 public:
  Candidates(int avatars, double per_m2);

  const BodyType& type() const { return *type_; }
  const std::vector<BodyPair>& pairs() const { return pairs_; }
  const std::vector<PartPose>& poses() const { return poses_; }
  const std::vector<Candidate>& list() const { return candidates_; }
  /// Indices into list(), sorted by bucket; bucket i is [starts()[i], starts()[i + 1]).
  const std::vector<uint32_t>& order() const { return order_; }
  const std::vector<uint32_t>& starts() const { return starts_; }

  const PartPose& pose_a(const Candidate& c) const {
    return poses_[pairs_[c.pair].pose_a + c.part_a];
  }
  const PartPose& pose_b(const Candidate& c) const {
    return poses_[pairs_[c.pair].pose_b + c.part_b];
  }
  Eigen::Vector3f shift_m(const Candidate& c) const {
    return Eigen::Vector3f(pairs_[c.pair].shift_m);
  }

 private:
  void find(const Crowd& crowd);
  void sort_into_buckets();

  std::shared_ptr<const BodyType> type_;
  std::vector<PartPose> poses_;
  std::vector<BodyPair> pairs_;
  std::vector<Candidate> candidates_;
  std::vector<uint32_t> order_, starts_;
};

/// The crowd of most micro-benchmarks, made once: 2000 people at 4 per m2, some 70 000 candidates.
const Candidates& crowd_candidates();

}  // namespace throng::bench
