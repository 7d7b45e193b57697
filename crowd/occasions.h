// When what groups and doors wait for comes.
// One rule: what has come stays; a time depends on the journeys of the decisions so far, and on
// nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "crowd/journeys.h"
#include "crowd/navigation/ways.h"
#include "crowd/spawn.h"

namespace throng {

class Occasions {
 public:
  /// Keeps a reference to `ways`.
  Occasions(const Ways& ways, std::span<const Person> people);

  /// Everything that watch() may have changed.
  void archive(Archive& a);

  /// Once a decision, when everybody has followed their journeys.
  void watch(const Journeys& journeys, double now_s);
  /// When it comes, or came; infinity while nobody can know.
  double time_s(uint32_t occasion) const { return times_s_[occasion]; }

 private:
  struct Range {
    uint32_t begin = 0, end = 0;
  };
  const Ways& ways_;
  std::vector<Range> people_of_;  ///< ids, by group
  std::vector<double> times_s_;
};

}  // namespace throng
