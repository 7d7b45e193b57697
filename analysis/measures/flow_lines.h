// The flow over a line: how many people pass it, and how fast one after another.
// One rule: without a line that somebody chose several are watched, and what is reported is the
// narrowest of those that the crowd uses.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/measures/measure_table.h"
#include "analysis/measures/recent_crowd.h"
#include "crowd/navigation/walkable.h"
#include "scenes/file/scene.h"

namespace throng {

class FlowLines {
 public:
  /// None: across the narrowest places, and through the middle of the ground.
  FlowLines(const Scene& scene, size_t people, std::optional<Passage> chosen);

  /// The way from the moment before the newest to the newest.
  void take(const RecentCrowd& crowd);

  struct Line {
    Passage across{};
    double width_m = 0;  ///< of it that people can walk on
    uint64_t forth = 0;  ///< to the left of the way from its first end to its second
    uint64_t back = 0;
    double first_s = 0;
    double last_s = 0;
    std::vector<uint8_t> is_near{};  ///< by person: passed, and not far from it since
    std::vector<uint8_t> went_by{};  ///< by person: crossed its straight beyond one of its ends
    /// How many did.
    uint64_t beside() const;
    uint64_t passed() const { return forth + back; }
    /// N - 1 over the time from the first to the last.
    double flow_per_s() const;
  };
  /// The one that counts: narrowest of those passed by a fifth as many as the busiest.
  const Line& used() const;
  MeasureTable table() const;

 private:
  std::vector<Line> lines_;  ///< at least one
  bool is_chosen_;
};

}  // namespace throng
