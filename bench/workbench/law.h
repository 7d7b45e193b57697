// The law of no misses for one volume: near pairs of parts by the million, odd bodies of every
// family and people who walk, held against triangles.
// One rule: the same pairs for any number of threads; the first miss is handed out whole.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/workers.h"
#include "bench/workbench/tested_volume.h"

namespace throng::bench {

/// A pair that touches and that a volume says is apart: all that a debugger needs to see why.
struct Miss {
  std::string where;  ///< family, seed, frame, bodies and parts
  PartShape shape_a, shape_b;
  PartPlace a, b;
  PlacedPair test;
};

struct LawRow {
  std::string family;
  uint64_t near = 0;       ///< pairs tested
  uint64_t touching = 0;   ///< by their triangles, or one inside the other
  uint64_t reported = 0;   ///< that the volume says may overlap
  uint64_t missed = 0;     ///< touching and not reported
  uint64_t differing = 0;  ///< of which the kernel says something else than the test one by one
  std::optional<Miss> first_miss{};

  void add(const LawRow& other);
};

/// A row a family, "walking" the last; at least `near_pairs` of them together.
std::vector<LawRow> check_law(const TestedVolume& volume, uint64_t near_pairs, uint64_t seed,
                              Workers& workers);

/// The shapes, poses and shift of a miss, as text that another program can read.
std::string to_text(const Miss& miss);

}  // namespace throng::bench
