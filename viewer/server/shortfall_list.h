// ShortfallList collects the separation shortfalls of a recorded run for the timeline.
// Invariant: its size is bounded; further shortfalls are left out.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "lcm_io/codec/rows.h"

namespace throng {

class ShortfallList {
 public:
  static constexpr size_t kCapacity = 10'000;

  /// Takes the begins and ends of a frame.
  void take(int64_t frame, std::span<const ShortfallEvent> events);

  /// Returns [[begin, end or -1, robot, person, region, max_shortfall_m], ...] by begin, where the
  /// end is the frame after the last one. -1: it lasts.
  nlohmann::json to_json() const;

 private:
  struct Entry {
    Shortfall shortfall;
    int64_t end_frame;
  };
  std::vector<Entry> entries_;
};

}  // namespace throng
