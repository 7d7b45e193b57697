// Broad phases that Throng is compared with, each behind one small adapter.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng::bench {

// A broad phase that Throng is compared with, behind one small adapter.
// Every engine is given the same boxes and has to list the same pairs; what it needs to
// get them into its own structures counts as its time, because an application would need it too.

/// A closed axis-aligned box in world axes, metres.
struct Box {
  float min_m[3];
  float max_m[3];
};

/// Closed boxes: touching counts.
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

/// Boxes of many avatars, avatar-major, the same number for each.
struct BoxList {
  std::span<const Box> boxes;
  uint32_t parts = 1;  ///< boxes an avatar

  bool same_avatar(uint32_t a, uint32_t b) const { return a / parts == b / parts; }
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual std::string name() const = 0;
  virtual std::string version() const = 0;
  /// What is timed, in a few words.
  virtual std::string what() const = 0;

  /// A fresh structure over a frame; update() may then be called with as many boxes.
  virtual void build(const BoxList& frame) = 0;
  virtual void update(const BoxList& frame) = 0;
  /// Replaces `out` by all overlapping pairs of boxes of different avatars, each once, a < b, in
  /// any order.
  virtual void pairs(std::vector<BoxPair>& out) = 0;
};

/// Appends a pair the right way round unless it is one avatar's own.
inline void append_pair(const BoxList& frame, uint32_t a, uint32_t b, std::vector<BoxPair>& out) {
  if (!frame.same_avatar(a, b)) out.push_back(a < b ? BoxPair{a, b} : BoxPair{b, a});
}

/// The engines that this binary can be compared with.
/// An engine that is not built in is named with the reason, never left out in silence.
struct EngineKind {
  std::string_view name;  ///< as given to --engines
  /// Null if it is not built in. `threads` is what the engine may use, if it can use more than one.
  std::unique_ptr<Engine> (*make)(int threads);
  std::string_view missing;  ///< why it is not built in
};

/// Every engine we know of, built in or not.
std::span<const EngineKind> engine_kinds();

}  // namespace throng::bench
