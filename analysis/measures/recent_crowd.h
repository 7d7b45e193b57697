// RecentCrowd stores the positions of roots and heads at the last few sampled instants.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kinematics/kinematics.h"
#include "scenes/run/sink.h"

namespace throng {

/// Positions of heads: the centre of the head part's box, by forward kinematics.
/// Avatars without a part named head use their root. Logs do not state which avatars are people, so
/// the name of the part decides.
class Heads {
 public:
  explicit Heads(const RunInfo& run);

  /// Writes positions seen from above, one per avatar, present or not. Requires a frame with
  /// postures.
  void find(const RunInfo& run, const Frame& frame, std::span<Eigen::Vector2d> out);

 private:
  struct Kind {
    std::optional<FlatModel> kinematics;  ///< chain of the head only; none: no head
    Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
    std::vector<uint32_t> avatars;
  };

  std::vector<Kind> kinds_;  ///< indexed by model
  std::vector<const float*> rows_;
  std::vector<RootFrame> roots_;
  std::vector<PartPose> poses_;
};

/// All people at one instant.
struct Moment {
  double time_s = 0;
  std::vector<Eigen::Vector2d> heads_m;
  std::vector<Eigen::Vector2d> roots_m;
  std::vector<uint8_t> present;
  /// Number of consecutive instants of presence, including this one; at most
  /// RecentCrowd::length().
  std::vector<uint16_t> stay;
};

/// Ring of moments. Memory depends on the number of people and on `length` only.
class RecentCrowd {
 public:
  RecentCrowd(size_t people, size_t length);

  size_t length() const { return moments_.size(); }
  /// The moment to fill in next; pushed() makes it the newest.
  Moment& next() { return moments_[newest_ + 1 == moments_.size() ? 0 : newest_ + 1]; }
  /// Updates `stay`. A jump of kJump_m or more interrupts it: another person, or the same one moved
  /// elsewhere.
  void pushed();
  static constexpr double kJump_m = 3;

  /// 0: the newest; must be below length(). Moments before the first have no people.
  const Moment& ago(size_t moments) const {
    return moments_[(newest_ + moments_.size() - moments) % moments_.size()];
  }
  /// True if the person was present from `back` instants before the moment `ago_moments` ago until
  /// `ahead` instants after it.
  bool stayed(size_t person, size_t ago_moments, size_t back, size_t ahead) const {
    return ago(ago_moments - ahead).stay[person] > back + ahead;
  }

 private:
  std::vector<Moment> moments_;
  size_t newest_ = 0;
};

}  // namespace throng
