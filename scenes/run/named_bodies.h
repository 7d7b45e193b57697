// NamedBodies finds the bodies that a name means, for filters and --publish-for.
// Invariant: an unknown name is an InputError, never an empty filter. A kind name means all bodies
// of that kind, regardless of the names of groups.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "culling/pair_filter.h"
#include "scenes/run/sink.h"

namespace throng {

/// `people`, `robots` (avatars of other models), `obstacles` and `all` name bodies of a kind.
/// `group:NAME` and `obstacle:NAME` name a group and an obstacle. Other names are looked up in
/// both.
class NamedBodies {
 public:
  /// Keeps a reference to the run.
  explicit NamedBodies(const RunInfo& run) : run_(run) {}

  /// Returns one flag per body id, avatars first: whether the name means it.
  std::vector<uint8_t> of(std::string_view name) const;
  std::vector<std::string> names() const;
  static bool is_kind(std::string_view name);
  /// Returns how to write the group or obstacle whose name is also a kind; "" if there is none.
  std::string namesake(std::string_view name) const;

 private:
  const RunInfo& run_;
};

/// Filter of a run: sides of bodies by id, avatars first, and of parts by type, models first.
/// Throws InputError, also if it omits pairs that the scene's separation needs.
PairFilter filter_of(const Scene& scene, const RunInfo& info);

/// One note for each kind name in the scene's filter that is also the name of a group or obstacle.
std::vector<std::string> filter_notes(const Scene& scene, const RunInfo& info);

}  // namespace throng
