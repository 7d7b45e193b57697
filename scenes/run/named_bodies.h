// NamedBodies finds the bodies of a run that a name means: in filters and in --tell.
// Invariant: a word that names bodies of a kind means all of that kind, whatever groups are called.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/run/sink.h"

namespace throng {

/// `people`, `robots` (avatars of other models), `obstacles` and `all` name bodies of a kind;
/// `group:NAME` and `obstacle:NAME` a group and an obstacle; any other name the group or the
/// obstacles that are called so.
class NamedBodies {
 public:
  /// Keeps a reference to the run.
  explicit NamedBodies(const RunInfo& run) : run_(run) {}

  /// One a body, by id, avatars first: whether the name means it.
  std::vector<uint8_t> of(std::string_view name) const;
  /// All that a name may be, for messages.
  std::vector<std::string> names() const;
  static bool is_kind(std::string_view name);
  /// How to write the group or the obstacle that is called as a word with another meaning: "" if
  /// none is called so.
  std::string namesake(std::string_view name) const;

 private:
  const RunInfo& run_;
};

}  // namespace throng
