#include "analysis/measures/recent_crowd.h"

#include <algorithm>

namespace throng {

RecentCrowd::RecentCrowd(size_t people, size_t length) : moments_(length) {
  for (Moment& moment : moments_) {
    moment.heads_m.resize(people, Eigen::Vector2d::Zero());
    moment.roots_m.resize(people, Eigen::Vector2d::Zero());
    moment.present.resize(people, 0);
    moment.stay.resize(people, 0);
  }
}

void RecentCrowd::pushed() {
  const Moment& before = moments_[newest_];
  Moment& now = next();
  for (size_t i = 0; i < now.present.size(); ++i) {
    const bool same = before.present[i] != 0 &&
                      (now.heads_m[i] - before.heads_m[i]).squaredNorm() < kJump_m * kJump_m;
    const size_t stay = now.present[i] == 0 ? 0 : same ? before.stay[i] + 1u : 1u;
    now.stay[i] = static_cast<uint16_t>(std::min(stay, moments_.size()));
  }
  newest_ = newest_ + 1 == moments_.size() ? 0 : newest_ + 1;
}

}  // namespace throng
