// Where people and their heads are, at one frame and at the last few sampled instants.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kinematics/kinematics.h"
#include "scenes/run/sink.h"

namespace throng {

/// Where the heads of people are: the centre of the head part's box, by forward kinematics of the
/// joint angles that a frame has.
/// Whoever has a part called head has a head, also in a log, which does not say who is a
/// person; anybody else is where the root is.
class Heads {
 public:
  explicit Heads(const RunInfo& run);

  /// Seen from above, one an avatar, whether present or not. The frame has postures.
  void find(const RunInfo& run, const Frame& frame, std::span<Eigen::Vector2d> out);

 private:
  struct Kind {
    std::optional<FlatModel> kinematics;  ///< of the head alone; none: no head
    Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
    std::vector<uint32_t> avatars;
  };

  std::vector<Kind> kinds_;  ///< by model
  std::vector<const float*> rows_;
  std::vector<RootFrame> roots_;
  std::vector<PartPose> poses_;
};

// Where everybody was at the last few sampled instants: what measures that need a little past and
// future look at.
// Memory depends on the people and on how far back is looked, never on the frames.

/// Everybody at one instant.
struct Moment {
  double time_s = 0;
  std::vector<Eigen::Vector2d> heads_m;
  std::vector<Eigen::Vector2d> roots_m;
  std::vector<uint8_t> present;
  /// For how many instants somebody has been there without a break, this one included; at most
  /// RecentCrowd::length().
  std::vector<uint16_t> stay;
};

class RecentCrowd {
 public:
  RecentCrowd(size_t people, size_t length);

  size_t length() const { return moments_.size(); }
  /// The moment to be filled in next; then pushed() makes it the newest.
  Moment& next() { return moments_[newest_ + 1 == moments_.size() ? 0 : newest_ + 1]; }
  /// Fills in how long everybody has stayed. A jump of kJump_m or more is a break: somebody else,
  /// or the same one put elsewhere.
  void pushed();
  static constexpr double kJump_m = 3;

  /// 0: the newest; below length(). One that has not been yet has nobody in it.
  const Moment& ago(size_t moments) const {
    return moments_[(newest_ + moments_.size() - moments) % moments_.size()];
  }
  /// True if somebody was there without a break from the moment so far ago, and a moment's count
  /// of instants `back` before it, until `ahead` after it.
  bool stayed(size_t person, size_t ago_moments, size_t back, size_t ahead) const {
    return ago(ago_moments - ahead).stay[person] > back + ahead;
  }

 private:
  std::vector<Moment> moments_;
  size_t newest_ = 0;
};

}  // namespace throng
