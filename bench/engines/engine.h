// Engine is the adapter interface of a broad phase that Throng is compared with.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng::bench {

// Every engine gets the same boxes and has to list the same pairs. Filling its own structures
// counts as its time, because an application needs that, too.

/// A closed axis-aligned box in world axes, metres.
struct Box {
  float min_m[3];
  float max_m[3];
};

/// Boxes are closed: touching boxes overlap.
inline bool overlap(const Box& a, const Box& b) {
  bool apart = false;
  for (int axis = 0; axis < 3; ++axis)
    apart |= a.min_m[axis] > b.max_m[axis] || b.min_m[axis] > a.max_m[axis];
  return !apart;
}

/// Indices of two boxes, a < b.
struct BoxPair {
  uint32_t a, b;
  auto operator<=>(const BoxPair&) const = default;
};

/// Boxes of many avatars, avatar-major, with the same number of boxes each.
struct BoxList {
  std::span<const Box> boxes;
  uint32_t parts = 1;  ///< boxes per avatar

  bool same_avatar(uint32_t a, uint32_t b) const { return a / parts == b / parts; }
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual std::string name() const = 0;
  virtual std::string version() const = 0;
  /// Describes the timed work in a few words.
  virtual std::string what() const = 0;

  /// Builds a new structure for a frame; update() may follow with the same number of boxes.
  virtual void build(const BoxList& frame) = 0;
  virtual void update(const BoxList& frame) = 0;
  /// Replaces `out` by all overlapping pairs of boxes of different avatars, each once with a < b,
  /// in any order.
  virtual void pairs(std::vector<BoxPair>& out) = 0;
};

/// Appends the pair with the lower index first, unless both boxes belong to one avatar.
inline void append_pair(const BoxList& frame, uint32_t a, uint32_t b, std::vector<BoxPair>& out) {
  if (!frame.same_avatar(a, b)) out.push_back(a < b ? BoxPair{a, b} : BoxPair{b, a});
}

/// Invariant: an engine that is not built in is listed with the reason.
struct EngineKind {
  std::string_view name;  ///< name in --engines
  /// Null if not built in. `threads`: the maximum for an engine that supports several.
  std::unique_ptr<Engine> (*make)(int threads);
  std::string_view missing;  ///< reason why it is not built in
};

/// Returns all known engines, built in or not.
std::span<const EngineKind> engine_kinds();

}  // namespace throng::bench
