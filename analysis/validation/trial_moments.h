// Moments of a trial at even times, for the measures that recordings are measured by.
// One rule: heads are where bodies have them; in a trial without bodies, where the roots are.
#pragma once

#include "analysis/measures/recent_crowd.h"
#include "analysis/validation/trial.h"

namespace throng::validation {

/// True at the first instant, and then at the first step at or after each multiple of a period.
class Every {
 public:
  explicit Every(double period_s) : period_s_(period_s) {}

  bool is_due(double now_s) {
    constexpr double kSlack_s = 1e-9;
    if (now_s < next_s_ - kSlack_s) return false;
    next_s_ += period_s_;
    return true;
  }

 private:
  double period_s_;
  double next_s_ = 0;
};

/// Where everybody is now; `moment` has room for them.
inline void take(const Trial& trial, Moment& moment) {
  moment.time_s = trial.now_s();
  for (size_t id = 0; id < trial.size(); ++id) {
    moment.roots_m[id] = trial.position_m(id);
    moment.heads_m[id] = trial.head_m(id);
    moment.present[id] = trial.is_present(id);
  }
}

}  // namespace throng::validation
