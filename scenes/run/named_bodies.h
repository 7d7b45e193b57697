// NamedBodies finds the bodies of a run that a name means: in filters and in --publish-for. A run's
// filter follows from the names of its rules; a name that means nobody is an error, never an empty
// answer. Invariant: a word that names bodies of a kind means all of that kind, whatever groups are
// called.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "culling/pair_filter.h"
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

/// The filter of a run: of bodies by id, avatars first, and of parts by type, models first. Throws
/// InputError, also where pairs are left out that the scene's separation is judged by.
PairFilter filter_of(const Scene& scene, const RunInfo& info);

/// A line for each word of the scene's `between` that a group or an obstacle is called, too.
std::vector<std::string> filter_notes(const Scene& scene, const RunInfo& info);

}  // namespace throng
